// SPDX-License-Identifier: Apache-2.0
// Any sequence of datagrams, images, triggers, recorded pings and pauses against a Gemini head.
// Promises: every datagram sent is a message of this head, small enough not to fragment; the next deadline
// lies in the future; time goes on with any input.
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "protocol/common/byte_reader.hpp"
#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "protocol/gemini/recorded_form.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace {

using namespace sonard::gemini;
using sonard::Actions;
using sonard::Ipv4;
using sonard::Outgoing;
using sonard::PingImage;
using sonard::PingJob;
using sonard::SharedBytes;
using sonard::TimePoint;
using sonard::fuzz::Event;
using sonard::fuzz::require;
using sonard::fuzz::Script;

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

class Bench {
 public:
  explicit Bench(unsigned flags) : config_(config_of(flags)), device_(config_, now_) {
    step(sonard::TimePassed{});
  }

  void play(const Event& event) {
    run_until(now_ + event.delay);
    switch (event.kind) {
      case feed:
        if (auto ping = recorded(event.datagram, now_)) {
          step(sonard::PingFed{std::move(*ping)});
        }
        break;
      case next_due:
        if (last_.next_ping && last_.next_ping->from <= now_) {
          step(sonard::NextPingDue{});
        }
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
        step(sonard::BytesReceived{{0, {clients[event.kind], 52900}, alternate_address},
                                   SharedBytes(event.datagram)});
    }
  }

 private:
  void run_until(TimePoint target) {
    constexpr int most_wake_ups = 1000;  // a few seconds of pings as large as answer_job() makes them
    for (int i = 0; i < most_wake_ups && last_.wake_at && *last_.wake_at <= target; ++i) {
      now_ = *last_.wake_at;
      step(sonard::TimePassed{});
    }
    now_ = target;
    step(sonard::TimePassed{});
  }

  void step(const sonard::Event& event) {
    last_ = device_.step(now_, event);
    for (const Outgoing& outgoing : last_.send) {
      const std::span<const std::uint8_t> bytes{outgoing.bytes};
      require(bytes.size() <= max_datagram_size, "no datagram fragments");
      const auto report = decode_report(bytes);
      require(report.has_value() && !std::holds_alternative<Unknown>(*report),
              "a head speaks its own protocol");
      require(header_of(*report).sonar_id == sonar_id, "a head signs with its own ID");
      require(outgoing.to == Outgoing::To::everybody || outgoing.peer.remote.address != 0,
              "every datagram has somewhere to go");
    }
    if (last_.render) {
      require(!job_.has_value(), "one job at a time");
      require(!config_.plays_back || last_.render->record.has_value(), "a player renders nothing");
      require(last_.render->native_bins > 0 && last_.render->bins() > 0, "a job has lines");
      job_ = *last_.render;
    }
    if (last_.record) {
      const auto samples = static_cast<std::size_t>(last_.record->settings.bins) * beam_count;
      require(last_.record->samples.size() == samples, "a record holds a whole image");
    }
    require(!last_.cancelled || (job_ && job_->number == *last_.cancelled), "what is cancelled is out");
    require(!last_.wake_at || *last_.wake_at > now_, "the next deadline is later than now");
  }

  void answer_job(bool rendered) {
    if (!job_) {
      return;
    }
    constexpr int most_lines = 512;  // more take time and test no other path
    const PingJob job = *job_;
    job_.reset();
    if (!rendered || job.bins() > most_lines) {
      step(sonard::PingNotRendered{job.number});
      return;
    }
    PingImage image;
    image.number = job.number;
    const auto samples = static_cast<std::size_t>(job.bins()) * beam_count;
    if (job.sixteen_bit) {
      image.u16.assign(samples, 0x1234);
    } else {
      image.u8.assign(samples, 0);
      for (std::size_t i = 0; i < samples; i += 7) {
        image.u8[i] = static_cast<std::uint8_t>(i);
      }
    }
    step(sonard::PingRendered{std::move(image)});
  }

  TimePoint now_{};
  DeviceConfig config_;
  Device device_;
  Actions last_;
  std::optional<PingJob> job_;
  bool out_of_water_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  Bench bench(data[0]);
  for (Script script{{data + 1, size - 1}, byte_kinds}; !script.done();) {
    Event event = script.next();
    if (event.kind != feed) {
      sonard::fuzz::address_to_gemini(event, sonar_id);
    }
    bench.play(event);
  }
  return 0;
}
