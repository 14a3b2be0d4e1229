// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/client.hpp"

#include "protocol/ping1d/codec.hpp"

namespace sonard::ping1d {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds answer_timeout{500};
constexpr milliseconds ping_timeout{2000};
constexpr milliseconds stop_period{100};
constexpr int stop_tries = 10;
constexpr std::uint32_t most_late = 16;  ///< pings
constexpr auto stream_id = static_cast<std::uint16_t>(Profile::id);

}  // namespace

void Client::on_bytes(TimePoint now, std::span<const std::uint8_t> bytes) {
  input_.append(now, bytes);
  while (const auto frame = input_.front()) {
    if (const auto report = decode_report(*frame)) {
      ++statistics_.frames;
      std::visit([&](const auto& message) { on_report(now, message); }, *report);
    } else {
      ++statistics_.bad_frames;
    }
    input_.pop();
  }
  statistics_.dropped_bytes = input_.dropped();
}

void Client::send(const Command& command) {
  outgoing_.push_back(encode(command));
}

void Client::on_report(TimePoint now, const DeviceInformation& information) {
  information_ = information;
  if (phase_ != Phase::meeting) {
    return;
  }
  phase_ = Phase::idle;
  due_.reset();
  if (settings_) {
    request_stream(now);
  }
}

void Client::start(TimePoint now, std::vector<Command> settings, std::uint64_t pings) {
  settings_ = std::move(settings);
  wanted_ = pings > 0 ? statistics_.pings + pings : 0;
  refusal_.reset();
  finished_ = false;
  if (phase_ != Phase::meeting) {
    request_stream(now);
  }
}

void Client::request_stream(TimePoint now) {
  phase_ = Phase::listening;
  for (const Command& setting : *settings_) {
    send(setting);
  }
  send(ContinuousStart{stream_id});
  due_ = now + ping_timeout;
}

/// A link may deliver a message twice or late. Only later pings count. Much smaller numbers are those of a
/// head that has restarted.
void Client::on_report(TimePoint now, const Profile& profile) {
  const bool late =
      last_number_ && profile.ping_number <= *last_number_ && *last_number_ - profile.ping_number < most_late;
  if (phase_ != Phase::listening || late) {
    return;
  }
  if (last_number_ && profile.ping_number > *last_number_) {
    statistics_.pings_missed += profile.ping_number - *last_number_ - 1;
  }
  last_number_ = profile.ping_number;
  ++statistics_.pings;
  pings_.push_back({now, profile.measured(), {profile.data.begin(), profile.data.end()}});
  due_ = now + ping_timeout;
  if (statistics_.pings == wanted_) {
    stop(now);
    finished_ = true;
  }
}

void Client::stop(TimePoint now) {
  settings_.reset();
  finished_ = phase_ == Phase::meeting;
  if (phase_ == Phase::listening) {
    phase_ = Phase::stopping;
    stop_orders_ = 0;
    due_ = now;
  }
}

void Client::on_report(TimePoint, const Ack& ack) {
  if (phase_ == Phase::stopping && ack.acked_id == static_cast<std::uint16_t>(ContinuousStop::id)) {
    phase_ = Phase::idle;
    due_.reset();
    finished_ = true;
  }
}

void Client::advance(TimePoint now) {
  if (!due_ || now < *due_) {
    return;
  }
  switch (phase_) {
    case Phase::meeting:
      send(GeneralRequest{static_cast<std::uint16_t>(ProtocolVersion::id)});
      send(GeneralRequest{static_cast<std::uint16_t>(DeviceInformation::id)});
      due_ = now + answer_timeout;
      return;
    case Phase::idle:
      due_.reset();
      return;
    case Phase::listening:
      ++statistics_.timeouts;
      request_stream(now);
      return;
    case Phase::stopping:
      if (stop_orders_++ == stop_tries) {
        phase_ = Phase::idle;
        due_.reset();
        finished_ = true;
        return;
      }
      send(ContinuousStop{stream_id});
      due_ = now + stop_period;
  }
}

}  // namespace sonard::ping1d
