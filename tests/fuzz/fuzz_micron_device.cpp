// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes, lines, faults, recorded lines and pauses against a Micron head.
// Promises, beside those of all heads: every frame sent is a whole message of this head.
#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <variant>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/device.hpp"
#include "protocol/micron/recorded_form.hpp"
#include "tests/fuzz/device_fuzzer.hpp"

namespace {

using namespace sonard::micron;
using sonard::Outgoing;
using sonard::PingJob;
using sonard::SharedBytes;
using sonard::fuzz::Event;
using sonard::fuzz::require;

/// Kinds of events. The first two carry bytes. One has type and data of a frame, or a raw piece of stream.
/// The other has a recorded line, as the frame that a log keeps or as the content of a head's frame.
enum Kind {
  byte_kinds = 2,
  feed = 1,
  client_gone = 2,
  power_cycle = 3,
  lose_step = 4,
  line = 5,
  line_failed = 6,
  next_due = 7
};

/// The configuration that the first byte of an input selects.
DeviceConfig config_of(unsigned flags) {
  DeviceConfig config;
  config.plays_back = (flags & 0x01U) != 0;
  config.simulated_time = (flags & 0x02U) != 0;
  config.always_reports_scan_right = (flags & 0x04U) != 0;
  config.requests_survive_head_command = (flags & 0x08U) == 0;
  return config;
}

class MicronFuzzer final : public sonard::fuzz::DeviceFuzzer {
 public:
  explicit MicronFuzzer(unsigned flags) : config_(config_of(flags)) {}

  int byte_kinds() const override { return Kind::byte_kinds; }

 private:
  sonard::Device& device() override { return device_; }
  const sonard::PingCounters& counters() const override { return device_.counters(); }
  bool plays_back() const override { return config_.plays_back; }
  int most_bins() const override { return max_bins; }

  void happen(const Event& event) override {
    switch (event.kind) {
      case feed:
        feed_line(event);
        break;
      case next_due:
        begin_next();
        break;
      case client_gone:
        step(sonard::ClientGone{});
        break;
      case power_cycle:
        device_.power_cycle(now());
        step(sonard::TimePassed{});
        break;
      case lose_step:
        device_.lose_step();
        break;
      case line:
        answer_job(true);
        break;
      case line_failed:
        answer_job(false);
        break;
      default:
        receive(event);
    }
  }

  /// Feeds a line, unless a replay would not begin with it (DeviceType::why_not_played()).
  void feed_line(const Event& event) {
    sonard::ReplayedPing ping;
    ping.wire = event.datagram;
    if (!event.as_is) {
      ping.wire = recorded_wire(HeadData{}, default_head_node);
      constexpr std::size_t tail = 3;  // count of no data, line feed
      const std::size_t most = ping.wire.size() - frame_header_size - tail;
      std::copy_n(event.datagram.begin(), std::min(most, event.datagram.size()),
                  ping.wire.begin() + frame_header_size);
    }
    if (!recorded_line(ping.wire)) {
      return;
    }
    ping.settings = {.bins = 20, .beams = 1, .bin_m = 0.01, .sound_speed_mps = 1500.0};
    step(sonard::PingFed{std::move(ping)});
  }

  void receive(const Event& event) {
    const std::span<const std::uint8_t> bytes = event.datagram;
    step(sonard::BytesReceived{
        {},
        SharedBytes(event.as_is || bytes.empty()
                        ? event.datagram
                        : frame_to_head(default_head_node, bytes[0], bytes.subspan(1)))});
  }

  void check_message(const Outgoing& outgoing) override {
    const std::span<const std::uint8_t> frame{outgoing.bytes};
    require(outgoing.to == Outgoing::To::everybody, "all clients share the line");
    require(next_frame(frame, max_report_frame_size) == static_cast<std::ptrdiff_t>(frame.size()),
            "one whole frame at a time");
    const FrameHeader header = frame_header(frame);
    require(header.tx_node == default_head_node && header.rx_node == client_node, "a head signs its frames");
    const auto report = decode_report(frame);
    require(report.has_value() && !std::holds_alternative<Unknown>(*report),
            "a head speaks its own protocol");
  }

  void check_job(const PingJob& job) const override { check_line_job(job); }
  void check_record(const sonard::PingRecord& record) const override {
    require(recorded_line(record.wire).has_value(), "a record can be played");
  }

  DeviceConfig config_;
  Device device_{config_, {}};
};

}  // namespace

std::unique_ptr<sonard::fuzz::DeviceFuzzer> sonard::fuzz::make_device_fuzzer(unsigned flags) {
  return std::make_unique<MicronFuzzer>(flags);
}
