// SPDX-License-Identifier: Apache-2.0
// Any sequence of datagrams, images, triggers and pauses against a Gemini head.
// Promises: every datagram that leaves is a message of a head, from this head, small enough not to fragment;
// the next deadline lies in the future; time goes on whatever comes in.
#include <optional>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace {

using namespace sonard::gemini;
using sonard::fuzz::Event;
using sonard::fuzz::require;
using sonard::fuzz::Script;

constexpr std::uint16_t sonar_id = 601;
constexpr Ipv4 alternate_address = 0xC0A802C9;
constexpr Ipv4 surfaces[] = {0xC0A80205, 0xC0A80206};

/// Kinds of events. The first two carry datagrams, one for each surface.
enum Kind { datagram_kinds = 2, trigger = 2, toggle_water = 3, image = 4, image_failed = 5 };

class Bench {
 public:
  Bench() : device_(config(), now_) {}

  void play(const Event& event) {
    run_until(now_ + event.delay);
    switch (event.kind) {
      case trigger:
        device_.on_trigger(now_);
        break;
      case toggle_water:
        out_of_water_ = !out_of_water_;
        device_.set_out_of_water(out_of_water_);
        break;
      case image:
        answer_job(true);
        break;
      case image_failed:
        answer_job(false);
        break;
      default:
        if (event.kind < datagram_kinds) {
          device_.on_datagram(now_, surfaces[event.kind], alternate_address, event.datagram);
        }
    }
    advance();
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
    for (int i = 0; i < most_wake_ups; ++i) {
      const auto deadline = device_.next_deadline();
      if (!deadline || *deadline > target) {
        break;
      }
      now_ = *deadline;
      advance();
    }
    now_ = target;
    advance();
  }

  void advance() {
    device_.advance(now_);
    for (const Outgoing& outgoing : device_.take_outgoing()) {
      const std::span<const std::uint8_t> bytes{outgoing.bytes};
      require(bytes.size() <= max_datagram_size, "no datagram fragments");
      const auto report = decode_report(bytes);
      require(report.has_value() && !std::holds_alternative<Unknown>(*report),
              "a head speaks its own protocol");
      require(header_of(*report).sonar_id == sonar_id, "a head signs with its own ID");
      require(outgoing.to == Outgoing::To::status || outgoing.surface != 0,
              "every datagram has somewhere to go");
    }
    if (auto job = device_.take_job()) {
      require(!job_.has_value(), "one job at a time");
      require(job->native_lines > 0 && job->lines() > 0, "a job has lines");
      job_ = *job;
    }
    const auto deadline = device_.next_deadline();
    require(!deadline || *deadline > now_, "the next deadline is later than now");
  }

  void answer_job(bool rendered) {
    if (!job_) {
      return;
    }
    constexpr int most_lines = 512;  // more take time and no other path
    const PingJob job = *job_;
    job_.reset();
    if (!rendered || job.lines() > most_lines) {
      device_.on_image_failed(now_, job.ping_number);
      return;
    }
    PingImage image;
    image.ping_number = job.ping_number;
    const auto samples = static_cast<std::size_t>(job.lines()) * beam_count;
    if (job.sixteen_bit) {
      image.u16.assign(samples, 0x1234);
    } else {
      image.u8.assign(samples, 0);
      for (std::size_t i = 0; i < samples; i += 7) {
        image.u8[i] = static_cast<std::uint8_t>(i);
      }
    }
    device_.on_image(now_, image);
  }

  TimePoint now_{};
  Device device_;
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
