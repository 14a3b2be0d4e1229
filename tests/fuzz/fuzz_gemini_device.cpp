// SPDX-License-Identifier: Apache-2.0
// Any sequence of datagrams, images, triggers, recorded pings and pauses against a Gemini head.
// Promises, beside those of all heads: every datagram sent is a message of this head, small enough not to
// fragment.
#include <bit>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "protocol/common/byte_reader.hpp"
#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "protocol/gemini/recorded_form.hpp"
#include "tests/fuzz/device_fuzzer.hpp"

namespace {

using namespace sonard::gemini;
using sonard::Ipv4;
using sonard::Outgoing;
using sonard::PingJob;
using sonard::SharedBytes;
using sonard::TimePoint;
using sonard::fuzz::Event;
using sonard::fuzz::require;

constexpr std::uint16_t sonar_id = 601;
constexpr Ipv4 alternate_address = 0xC0A802C9;
constexpr Ipv4 clients[] = {0xC0A80205, 0xC0A80206};

/// Kinds of events. The first three carry bytes: a datagram for each client, and a recorded ping.
enum Kind {
  byte_kinds = 3,
  feed = 2,
  trigger = 3,
  toggle_water = 4,
  image = 5,
  image_failed = 6,
  next_due = 7
};

/// The configuration that the first byte of an input selects.
DeviceConfig config_of(unsigned flags) {
  DeviceConfig config;
  config.sonar_id = sonar_id;
  config.alternate_address = alternate_address;
  config.plays_back = (flags & 0x01U) != 0;
  config.simulated_time = (flags & 0x02U) != 0;
  config.lock_to_first = (flags & 0x04U) != 0;
  config.snap_sound_speed = (flags & 0x08U) != 0;
  return config;
}

/// A ping of a log: lines, 256 beams or one, line length, sound speed and gain, as far as there are bytes.
/// nullopt if a replay would not begin with it (server/logs, DeviceType::why_not_played()).
std::optional<sonard::ReplayedPing> recorded(std::span<const std::uint8_t> bytes, TimePoint now) {
  sonard::ByteReader reader(bytes);
  const auto number = [&](double fallback) {
    return reader.remaining() < 8 ? fallback : std::bit_cast<double>(reader.u64le("number"));
  };
  sonard::ReplayedPing ping;
  const int flags = reader.remaining() > 0 ? reader.u8("flags") : 0;
  ping.settings.bins = reader.remaining() < 2 ? 40 : reader.u16le("lines");
  ping.settings.beams = (flags & 1) != 0 ? 1 : beam_count;
  if ((flags & 2) != 0) {
    ping.due = now;
  }
  ping.settings.bin_m = number(0.05);
  ping.settings.sound_speed_mps = number(1500.0);
  ping.settings.gain_percent = number(-1.0);
  const auto makes_sense = [](double value) { return std::isfinite(value) && value > 0.0; };
  const bool played = makes_sense(ping.settings.bin_m) && makes_sense(ping.settings.sound_speed_mps) &&
                      recorded_form(ping.settings).has_value();
  return played ? std::optional(ping) : std::nullopt;
}

class GeminiFuzzer final : public sonard::fuzz::DeviceFuzzer {
 public:
  explicit GeminiFuzzer(unsigned flags) : config_(config_of(flags)) {}

  int byte_kinds() const override { return Kind::byte_kinds; }

 private:
  sonard::Device& device() override { return device_; }
  const sonard::PingCounters& counters() const override { return device_.counters(); }
  bool plays_back() const override { return config_.plays_back; }
  int beams() const override { return beam_count; }
  int most_bins() const override { return 512; }

  void happen(const Event& event) override {
    switch (event.kind) {
      case feed:
        if (auto ping = recorded(event.datagram, now())) {
          step(sonard::PingFed{std::move(*ping)});
        }
        break;
      case next_due:
        begin_next();
        break;
      case trigger:
        step(sonard::TriggerEdge{});
        break;
      case toggle_water:
        out_of_water_ = !out_of_water_;
        step(sonard::WaterChanged{out_of_water_});
        break;
      case image:
        answer_job(true);
        break;
      case image_failed:
        answer_job(false);
        break;
      default:
        receive(event);
    }
  }

  void receive(Event event) {
    sonard::fuzz::address_to_gemini(event, sonar_id);
    step(sonard::BytesReceived{{0, {clients[event.kind], 52900}, alternate_address},
                               SharedBytes(std::move(event.datagram))});
  }

  void check_message(const Outgoing& outgoing) override {
    const std::span<const std::uint8_t> bytes{outgoing.bytes};
    require(bytes.size() <= max_datagram_size, "no datagram fragments");
    const auto report = decode_report(bytes);
    require(report.has_value() && !std::holds_alternative<Unknown>(*report),
            "a head speaks its own protocol");
    require(header_of(*report).sonar_id == sonar_id, "a head signs with its own ID");
    require(outgoing.to == Outgoing::To::everybody || outgoing.peer.remote.address != 0,
            "every datagram has somewhere to go");
  }

  DeviceConfig config_;
  Device device_{config_, {}};
  bool out_of_water_ = false;
};

}  // namespace

std::unique_ptr<sonard::fuzz::DeviceFuzzer> sonard::fuzz::make_device_fuzzer(unsigned flags) {
  return std::make_unique<GeminiFuzzer>(flags);
}
