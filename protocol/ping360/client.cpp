// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/client.hpp"

#include <algorithm>
#include <utility>

#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds answer_timeout{500};
constexpr milliseconds ping_timeout{4200};
constexpr milliseconds quiet_time{200};  ///< from an empty datagram to the scan command
constexpr seconds sign_of_life{10};      ///< a head may end the scan of a silent client
constexpr milliseconds stop_period{100};
constexpr int stop_tries = 10;

}  // namespace

Client::Client(TimePoint now) : due_(now) {}

// ---- Frames

void Client::on_bytes(TimePoint now, std::span<const std::uint8_t> bytes) {
  input_.append(now, bytes);
  while (const auto frame = input_.front()) {
    take_frame(now, *frame);
    input_.pop();
  }
  statistics_.dropped_bytes = input_.dropped();
}

void Client::take_frame(TimePoint now, std::span<const std::uint8_t> frame) {
  const auto report = decode_report(frame);
  if (!report) {
    ++statistics_.bad_frames;
    return;
  }
  ++statistics_.frames;
  std::visit([&](const auto& message) { on_report(now, message); }, *report);
}

void Client::send(const Command& command) {
  outgoing_.push_back(encode(command));
}

// ---- Meeting the head

void Client::ask_identity(TimePoint now) {
  const MessageId missing = !head_.protocol      ? MessageId::protocol_version
                            : !head_.information ? MessageId::device_information
                                                 : MessageId::device_data;
  if (head_.state) {
    phase_ = Phase::idle;
    due_.reset();
    if (programme_) {
      ask_for_pings(now);
    }
    return;
  }
  send(GeneralRequest{static_cast<std::uint16_t>(missing)});
  due_ = now + answer_timeout;
}

void Client::on_report(TimePoint now, const ProtocolVersion& version) {
  head_.protocol = version;
  if (phase_ == Phase::meeting) {
    ask_identity(now);
  }
}

void Client::on_report(TimePoint now, const DeviceInformation& information) {
  head_.information = information;
  if (phase_ == Phase::meeting) {
    ask_identity(now);
  }
}

// ---- Pings

void Client::start(TimePoint now, const Transducer& first, int step, std::uint64_t pings) {
  begin(now, {first, step, pings});
}

void Client::start(TimePoint now, const AutoTransmit& scan, std::uint64_t pings) {
  begin(now, {scan, 0, pings});
}

void Client::begin(TimePoint now, const Programme& programme) {
  programme_ = programme;
  sign_of_life_due_.reset();
  refusal_.reset();
  finished_ = false;
  if (phase_ != Phase::meeting) {
    ask_for_pings(now);
  }
}

/// Ends a scan of an earlier client before starting a new scan.
void Client::ask_for_pings(TimePoint now) {
  if (std::holds_alternative<AutoTransmit>(programme_->command)) {
    outgoing_.emplace_back();
    phase_ = Phase::quieting;
    due_ = now + quiet_time;
  } else {
    order(now);
  }
}

void Client::order(TimePoint now) {
  phase_ = Phase::pinging;
  std::visit([&](const auto& command) { send(command); }, programme_->command);
  ++statistics_.commands;
  due_ = now + ping_timeout;
  if (std::holds_alternative<AutoTransmit>(programme_->command)) {
    sign_of_life_due_ = now + sign_of_life;
  }
}

/// A link may deliver an answer twice. Each ping triggers the next command, so a copy must not count. Other
/// settings are not compared, because a head that plays a recording reports the recorded settings.
void Client::on_report(TimePoint now, const DeviceData& data) {
  const std::vector<std::uint8_t> before = std::exchange(last_data_, encode(data));
  if (phase_ == Phase::meeting) {
    head_.state = form_of(Report{data});
    ask_identity(now);
    return;
  }
  if (phase_ == Phase::stopping) {
    return;  // The head pings until the stop command reaches it.
  }
  auto* const command = programme_ ? std::get_if<Transducer>(&programme_->command) : nullptr;
  const bool unwanted = phase_ != Phase::pinging || command == nullptr;
  if (unwanted || (last_data_ == before && form_of(Report{data}) != form_of(*command))) {
    ++statistics_.pings_unwanted;
    return;
  }
  deliver(now, data, data.data);
  if (programme_) {
    command->angle = static_cast<std::uint16_t>(wrapped(command->angle + programme_->step));
    order(now);
  }
}

/// Compares only the settings of the scan, because a head that plays a recording reports recorded settings.
void Client::on_report(TimePoint now, const AutoDeviceData& data) {
  if (phase_ == Phase::stopping) {
    return;
  }
  const auto* const command = programme_ ? std::get_if<AutoTransmit>(&programme_->command) : nullptr;
  const bool wanted = phase_ == Phase::pinging && command != nullptr &&
                      data.start_angle == command->start_angle && data.stop_angle == command->stop_angle &&
                      data.num_steps == command->num_steps && data.delay_ms == command->delay_ms;
  if (!wanted) {
    ++statistics_.pings_unwanted;
    return;
  }
  due_ = now + ping_timeout;
  deliver(now, data, data.data);
}

/// Delivers a ping. After the last one it stops a scan, which never ends by itself.
void Client::deliver(TimePoint now, const Report& report, std::span<const std::uint8_t> data) {
  pings_.push_back({programme_->delivered++, now, *form_of(report), {data.begin(), data.end()}});
  ++statistics_.pings;
  if (programme_->wanted == 0 || programme_->delivered < programme_->wanted) {
    return;
  }
  if (std::holds_alternative<AutoTransmit>(programme_->command)) {
    stop(now);
  } else {
    become_idle();
  }
  finished_ = true;
}

void Client::become_idle() {
  phase_ = Phase::idle;
  programme_.reset();
  due_.reset();
  sign_of_life_due_.reset();
}

void Client::on_report(TimePoint, const Nack& nack) {
  if (phase_ == Phase::pinging &&
      nack.nacked_id ==
          std::visit([](const auto& command) { return id_of(Command{command}); }, programme_->command)) {
    refusal_ = nack;
    become_idle();
    finished_ = true;
  }
}

// ---- The end

void Client::stop(TimePoint now) {
  if (phase_ == Phase::meeting) {
    programme_.reset();
    finished_ = true;
    return;
  }
  finished_ = false;
  if (phase_ == Phase::stopping) {
    return;
  }
  become_idle();
  phase_ = Phase::stopping;
  stop_orders_ = 0;
  on_timeout(now);
}

void Client::on_report(TimePoint, const Ack& ack) {
  if (phase_ == Phase::stopping && ack.acked_id == static_cast<std::uint16_t>(MotorOff::id)) {
    become_idle();
    finished_ = true;
  }
}

// ---- Time

void Client::on_timeout(TimePoint now) {
  switch (phase_) {
    case Phase::meeting:
      ask_identity(now);
      return;
    case Phase::idle:
      due_.reset();
      return;
    case Phase::quieting:
      order(now);
      return;
    case Phase::pinging:
      ++statistics_.timeouts;
      ask_for_pings(now);
      return;
    case Phase::stopping:
      if (stop_orders_ == stop_tries) {
        become_idle();
        finished_ = true;
        return;
      }
      ++stop_orders_;
      send(MotorOff{});
      due_ = now + stop_period;
  }
}

void Client::advance(TimePoint now) {
  if (due_ && now >= *due_) {
    on_timeout(now);
  }
  if (sign_of_life_due_ && now >= *sign_of_life_due_) {
    send(GeneralRequest{static_cast<std::uint16_t>(MessageId::protocol_version)});
    sign_of_life_due_ = now + sign_of_life;
  }
}

std::optional<TimePoint> Client::next_deadline() const {
  return due_ && sign_of_life_due_ ? std::min(due_, sign_of_life_due_) : due_;
}

std::vector<std::vector<std::uint8_t>> Client::take_outgoing() {
  return std::exchange(outgoing_, {});
}

std::vector<ReceivedPing> Client::take_pings() {
  return std::exchange(pings_, {});
}

}  // namespace sonard::ping360
