// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/client.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {
namespace {

using std::chrono::seconds;

constexpr seconds silence_before_asking{2};  // a head with stopped alives only answers requests
constexpr seconds answer_timeout{1};
constexpr seconds alive_timeout{3};
constexpr int user_block_tries = 3;
constexpr int alives_to_take_parameters = 3;
constexpr int request_tries = 5;

}  // namespace

Client::Client(const ClientConfig& config, TimePoint now)
    : config_(config), input_(max_report_frame_size), due_(now + silence_before_asking) {
  if (config_.reboot_first) {
    send(Reboot{});
  }
}

// ---- Frames

void Client::on_bytes(TimePoint now, std::span<const std::uint8_t> bytes) {
  input_.append(now, bytes);
  while (const auto frame = input_.front(now)) {
    take_frame(now, frame->bytes);
    input_.pop();
  }
  statistics_.dropped_bytes = input_.dropped();
}

void Client::take_frame(TimePoint now, std::span<const std::uint8_t> frame) {
  const FrameHeader header = frame_header(frame);
  if (header.tx_node != config_.node || header.rx_node != client_node) {
    ++statistics_.other_nodes;
    if (header.rx_node == client_node) {
      other_heads_.insert(header.tx_node);
    }
    return;
  }
  const auto report = decode_report(frame);
  if (!report) {
    ++statistics_.bad_frames;
    return;
  }
  ++statistics_.frames;
  std::visit([&](const auto& message) { on_report(now, message); }, *report);
}

template <class Message>
void Client::send(const Message& message) {
  outgoing_.push_back(encode(message, config_.node));
}

// ---- Meeting the head

void Client::ask_identity(TimePoint now) {
  asked_ = true;
  due_ = now + answer_timeout;
  if (!head_.version) {
    send(SendVersion{});
  } else if (tries_ < user_block_tries) {
    ++tries_;
    send(SendBBUser{});
  } else {
    met(now);  // without user blocks this client requests single lines
  }
}

void Client::on_report(TimePoint now, const VersionData& version) {
  head_.version = version;
  if (phase_ == Phase::meeting) {
    ask_identity(now);
  }
}

void Client::on_report(TimePoint now, const BBUserData& blocks) {
  head_.user_blocks = blocks;
  if (phase_ == Phase::meeting && head_.version) {
    met(now);
  }
}

void Client::met(TimePoint now) {
  phase_ = Phase::idle;
  due_.reset();
  if (programme_ && !finished()) {
    configure(now);
  }
}

// ---- Parameters

void Client::start(TimePoint now, const HeadCommand& parameters, std::uint64_t lines) {
  programme_ = Programme{parameters, lines, 0};
  stopped_ = false;
  if (phase_ != Phase::meeting) {
    configure(now);
  }
}

void Client::stop() {
  stopped_ = true;
  if (phase_ != Phase::meeting) {
    phase_ = Phase::idle;
    due_.reset();
  }
}

void Client::set_gain(const GainBlock& values) {
  if (!programme_) {
    return;
  }
  HeadCommand& parameters = programme_->parameters;
  parameters.ad_span = values.ad_span[0];
  parameters.ad_low = values.ad_low[0];
  parameters.gain = values.gain;
  parameters.slope = values.slope;
  if (phase_ == Phase::scanning) {
    send(GainCommand{values});
  }
}

void Client::reverse() {
  if (!programme_) {
    return;
  }
  programme_->parameters.control ^= control_bits::scan_right;
  if (phase_ == Phase::scanning) {
    send(ReverseCommand{});
  }
}

void Client::configure(TimePoint now) {
  phase_ = Phase::configuring;
  tries_ = 0;
  expected_ = 0;
  due_ = now + alive_timeout;
  send(programme_->parameters);
  ++statistics_.head_commands;
}

void Client::on_report(TimePoint now, const Alive& alive) {
  ++statistics_.alives;
  head_.alive = alive;
  const bool told = alive.has(head_info_bits::sent_config) || !alive.has(head_info_bits::no_parameters);
  if (phase_ == Phase::meeting && !asked_) {
    ask_identity(now);
  } else if (phase_ == Phase::configuring) {
    due_ = now + alive_timeout;
    if (told && alive.has(head_info_bits::centred)) {
      phase_ = Phase::scanning;
      tries_ = 0;
      request(now);
    } else if (!told && ++tries_ >= alives_to_take_parameters) {
      configure(now);
    }
  } else if (phase_ == Phase::scanning && !told) {
    ++statistics_.reboots;
    configure(now);
  }
}

// ---- Lines

int Client::lines_per_request() const {
  return head_.user_blocks && !head_.user_blocks->half_duplex() ? 2 : 1;
}

std::chrono::nanoseconds Client::line_timeout() const {
  const HeadCommand& parameters = programme_->parameters;
  return answer_timeout + 2 * parameters.bins * parameters.ad_interval * ad_interval_unit;
}

/// In full duplex this is called while one requested line is still to come.
void Client::request(TimePoint now) {
  send(SendData{});
  ++statistics_.requests;
  expected_ += lines_per_request();
  due_ = now + line_timeout();
}

/// Compares the parameters as drivers do, except gain and window, which may change during a scan.
bool Client::matches(const HeadData& line) const {
  const HeadCommand& asked = programme_->parameters;
  constexpr unsigned compared = control_bits::eight_bit | control_bits::continuous | control_bits::invert;
  const std::size_t bytes = line.eight_bit() ? asked.bins : (asked.bins + 1U) / 2U;
  return ((line.control ^ asked.control) & compared) == 0 && line.left_limit == asked.left_limit &&
         line.right_limit == asked.right_limit && line.step == asked.step &&
         line.ad_interval == asked.ad_interval && line.data.size() == bytes;
}

void Client::on_report(TimePoint now, const HeadData& line) {
  if (phase_ != Phase::scanning) {
    ++statistics_.lines_unrequested;
    return;
  }
  if (!matches(line)) {
    ++statistics_.lines_unmatched;
    return;
  }
  if ((line.status & head_status_bits::motor_error) != 0) {
    ++statistics_.motor_errors;
    configure(now);
    return;
  }
  ReceivedLine received{programme_->delivered++, now, line, {line.data.begin(), line.data.end()}};
  received.head.data = {};
  if (!line.eight_bit()) {
    received.bins = unpack_nibbles(line.data, config_.nibble_order);
    received.bins.resize(programme_->parameters.bins);
  }
  lines_.push_back(std::move(received));
  ++statistics_.lines;
  tries_ = 0;
  expected_ = std::max(0, expected_ - 1);
  due_ = now + line_timeout();
  if (finished()) {
    phase_ = Phase::idle;
    due_.reset();
  } else if (expected_ < lines_per_request()) {
    request(now);
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
    case Phase::configuring:  // alives were stopped or the head is gone; a request finds out
      phase_ = Phase::scanning;
      tries_ = 0;
      request(now);
      return;
    case Phase::scanning:
      ++statistics_.timeouts;
      expected_ = 0;
      if (++tries_ >= request_tries) {
        configure(now);
      } else {
        request(now);
      }
  }
}

void Client::advance(TimePoint now) {
  if (due_ && now >= *due_) {
    on_timeout(now);
  }
}

std::optional<TimePoint> Client::next_deadline() const {
  return due_;
}

std::vector<std::vector<std::uint8_t>> Client::take_outgoing() {
  return std::exchange(outgoing_, {});
}

std::vector<ReceivedLine> Client::take_lines() {
  return std::exchange(lines_, {});
}

}  // namespace sonard::micron
