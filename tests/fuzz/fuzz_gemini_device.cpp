// SPDX-License-Identifier: Apache-2.0
// Any sequence of datagrams, images, triggers and pauses against a Gemini head.
// Promises: every datagram that leaves is a message of a head, from this head, small enough not to fragment;
// the next deadline lies in the future; time goes on whatever comes in.
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
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
constexpr Ipv4 topsides[] = {0xC0A80205, 0xC0A80206};

/// Kinds of events. The first two carry datagrams, one for each topside.
enum Kind { datagram_kinds = 2, trigger = 2, toggle_water = 3, image = 4, image_failed = 5 };

class Bench {
 public:
  Bench() : device_(config(), now_) { step(sonard::TimePassed{}); }

  void play(const Event& event) {
    run_until(now_ + event.delay);
    switch (event.kind) {
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
        if (event.kind < datagram_kinds) {
          const sonard::Peer from{0, {topsides[event.kind], 52900}, alternate_address};
          step(sonard::BytesReceived{from, SharedBytes(event.datagram)});
        }
    }
  }

 private:
  static DeviceConfig config() {
    DeviceConfig config;
    config.sonar_id = sonar_id;
    config.alternate_address = alternate_address;
    return config;
  }

  void run_until(TimePoint target) {
    constexpr int most_wake_ups = 1000;  // a few seconds of pings as large as answer_job() makes them
    for (int i = 0; i < most_wake_ups && wake_at_ && *wake_at_ <= target; ++i) {
      now_ = *wake_at_;
      step(sonard::TimePassed{});
    }
    now_ = target;
    step(sonard::TimePassed{});
  }

  void step(const sonard::Event& event) {
    const Actions actions = device_.step(now_, event);
    for (const Outgoing& outgoing : actions.send) {
      const std::span<const std::uint8_t> bytes{outgoing.bytes};
      require(bytes.size() <= max_datagram_size, "no datagram fragments");
      const auto report = decode_report(bytes);
      require(report.has_value() && !std::holds_alternative<Unknown>(*report),
              "a head speaks its own protocol");
      require(header_of(*report).sonar_id == sonar_id, "a head signs with its own ID");
      require(outgoing.to == Outgoing::To::everybody || outgoing.peer.remote.address != 0,
              "every datagram has somewhere to go");
    }
    if (actions.render) {
      require(!job_.has_value(), "one job at a time");
      require(actions.render->native_bins > 0 && actions.render->bins() > 0, "a job has lines");
      job_ = *actions.render;
    }
    if (actions.record) {
      const auto samples = static_cast<std::size_t>(actions.record->settings.bins) * beam_count;
      require(actions.record->samples.size() == samples, "a record holds a whole image");
    }
    require(!actions.cancelled || (job_ && job_->number == *actions.cancelled), "what is cancelled is out");
    require(!actions.wake_at || *actions.wake_at > now_, "the next deadline is later than now");
    wake_at_ = actions.wake_at;
  }

  void answer_job(bool rendered) {
    if (!job_) {
      return;
    }
    constexpr int most_lines = 512;  // more take time and no other path
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
  Device device_;
  std::optional<TimePoint> wake_at_;
  std::optional<PingJob> job_;
  bool out_of_water_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bench bench;
  for (Script script{{data, size}, datagram_kinds}; !script.done();) {
    Event event = script.next();
    sonard::fuzz::address_to_gemini(event, sonar_id);
    bench.play(event);
  }
  return 0;
}
