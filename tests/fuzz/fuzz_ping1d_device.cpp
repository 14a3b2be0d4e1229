// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes of three clients, images, faults and pauses against a Ping1D.
// Promises, beside those of all heads: every frame sent is a whole message of a head, for one peer.
#include <memory>
#include <span>
#include <variant>

#include "protocol/ping1d/codec.hpp"
#include "protocol/ping1d/device.hpp"
#include "protocol/ping1d/recorded_form.hpp"
#include "tests/fuzz/device_fuzzer.hpp"

namespace {

using namespace sonard::ping1d;
using sonard::Outgoing;
using sonard::Peer;
using sonard::PingJob;
using sonard::SharedBytes;
using sonard::fuzz::Event;
using sonard::fuzz::require;

/// Kinds of events. The first three carry bytes, each from its own client: number and payload of a message,
/// or a raw piece of stream.
enum Kind { byte_kinds = 3, client_gone = 3, image = 4, image_failed = 5, feed = 6, next_due = 7 };

constexpr int serial_channel = 2;

Peer peer_of(int kind) {
  const auto number = static_cast<std::uint16_t>(kind);
  return kind == serial_channel ? Peer{serial_channel, {}, 0} : Peer{0, {0x7F000001, number}, 0};
}

/// The configuration that the first byte of an input selects.
DeviceConfig config_of(unsigned flags) {
  DeviceConfig config;
  config.serial_channel = serial_channel;
  config.plays_back = (flags & 0x01U) != 0;
  config.simulated_time = (flags & 0x02U) != 0;
  config.fan_out = (flags & 0x04U) != 0 ? FanOut::all : FanOut::requester;
  config.time_scale = (flags & 0x08U) != 0 ? 0.0 : 1.0;
  config.points = (flags & 0x10U) != 0 ? 10 : 200;
  config.acknowledges = (flags & 0x20U) == 0;
  config.refuses_silently_in_auto = (flags & 0x40U) != 0;
  config.max_clients = (flags & 0x80U) != 0 ? 2 : 32;
  return config;
}

class Ping1dFuzzer final : public sonard::fuzz::DeviceFuzzer {
 public:
  explicit Ping1dFuzzer(unsigned flags) : config_(config_of(flags)) {}

  int byte_kinds() const override { return Kind::byte_kinds; }

 private:
  sonard::Device& device() override { return device_; }
  const sonard::PingCounters& counters() const override { return device_.counters(); }
  bool plays_back() const override { return config_.plays_back; }
  int most_bins() const override { return 10'000; }

  void happen(const Event& event) override {
    switch (event.kind) {
      case client_gone:
        step(sonard::ClientGone{peer_of(0)});
        break;
      case image:
        answer_job(true);
        break;
      case image_failed:
        answer_job(false);
        break;
      case feed:
        step(sonard::PingFed{recorded()});
        break;
      case next_due:
        begin_next();
        break;
      default:
        hear(event);
    }
  }

  static sonard::ReplayedPing recorded() {
    sonard::ReplayedPing ping;
    ping.settings = {.bins = 20, .beams = 1, .bin_m = 0.1, .sound_speed_mps = 1500.0};
    ping.wire = record_of({.distance_mm = 700, .scan_length_mm = 2000}, {}, 1500.0, 1).wire;
    return ping;
  }

  void hear(const Event& event) {
    const std::span<const std::uint8_t> bytes = event.datagram;
    const bool as_is = event.as_is || bytes.size() < 2;
    step(sonard::BytesReceived{
        peer_of(event.kind),
        SharedBytes(as_is ? event.datagram
                          : make_frame(static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8), client_id, 0,
                                       bytes.subspan(2)))});
  }

  void check_message(const Outgoing& outgoing) override {
    require(outgoing.to == Outgoing::To::peer, "messages are for one peer each");
    const std::span<const std::uint8_t> frame{outgoing.bytes};
    require(next_frame(frame) == static_cast<std::ptrdiff_t>(frame.size()), "one whole frame at a time");
    const auto report = decode_report(frame);
    require(report.has_value() && !std::holds_alternative<Unknown>(*report),
            "a head speaks its own protocol");
  }

  void check_job(const PingJob& job) const override {
    require(job.bins() <= most_bins(), "a job can be rendered");
    require(job.transmit_time <= now(), "a job is not ahead of its time");
  }

  void check_record(const sonard::PingRecord& record) const override {
    require(recorded_form(record.wire).has_value(), "a record can be played");
  }

  DeviceConfig config_;
  Device device_{config_, {}};
};

}  // namespace

std::unique_ptr<sonard::fuzz::DeviceFuzzer> sonard::fuzz::make_device_fuzzer(unsigned flags) {
  return std::make_unique<Ping1dFuzzer>(flags);
}
