// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes, lines, faults and pauses against a Micron head.
// Promises: every frame that leaves is a whole message of a head, from this head; the next deadline lies in
// the future; no more lines than were asked for; time goes on whatever comes in.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/device.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace {

using namespace sonard::micron;
using sonard::Actions;
using sonard::Outgoing;
using sonard::PingImage;
using sonard::PingJob;
using sonard::SharedBytes;
using sonard::TimePoint;
using sonard::fuzz::Event;
using sonard::fuzz::require;
using sonard::fuzz::Script;

/// Kinds of events. The first carries bytes: type and data of a frame, or a piece of stream as it is.
enum Kind { byte_kinds = 1, host_gone = 1, power_cycle = 2, lose_step = 3, line = 4, line_failed = 5 };

class Bench {
 public:
  Bench() { step(sonard::TimePassed{}); }

  void play(const Event& event) {
    run_until(now_ + event.delay);
    switch (event.kind) {
      case host_gone:
        step(sonard::ClientGone{});
        break;
      case power_cycle:
        device_.power_cycle(now_);
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
        if (event.kind < byte_kinds) {
          hear(event);
        }
    }
  }

 private:
  void hear(const Event& event) {
    const std::span<const std::uint8_t> bytes = event.datagram;
    step(sonard::BytesReceived{
        {},
        SharedBytes(event.as_is || bytes.empty()
                        ? event.datagram
                        : frame_to_head(default_head_node, bytes[0], bytes.subspan(1)))});
  }

  void run_until(TimePoint target) {
    constexpr int most_wake_ups = 1000;
    for (int i = 0; i < most_wake_ups && wake_at_ && *wake_at_ <= target; ++i) {
      now_ = std::max(now_, *wake_at_);
      step(sonard::TimePassed{});
    }
    now_ = target;
    step(sonard::TimePassed{});
  }

  void step(const sonard::Event& event) {
    const Actions actions = device_.step(now_, event);
    for (const Outgoing& outgoing : actions.send) {
      const std::span<const std::uint8_t> frame{outgoing.bytes};
      require(outgoing.to == Outgoing::To::everybody, "all clients share the line");
      require(next_frame(frame, max_report_frame_size) == static_cast<std::ptrdiff_t>(frame.size()),
              "one whole frame at a time");
      const FrameHeader header = frame_header(frame);
      require(header.tx_node == default_head_node && header.rx_node == host_node, "a head signs its frames");
      const auto report = decode_report(frame);
      require(report.has_value() && !std::holds_alternative<Unknown>(*report),
              "a head speaks its own protocol");
    }
    if (actions.render) {
      const PingJob& job = *actions.render;
      require(!job_.has_value(), "one job at a time");
      require(job.bins() >= 1 && job.bins() <= max_bins, "a job can be rendered");
      constexpr double half_a_turn = std::numbers::pi + 1e-9;  // and what rounding makes of it
      require(std::abs(job.bearing_rad) <= half_a_turn, "a job has a bearing of one turn");
      require(job.transmit_time <= now_, "a job is not ahead of its time");
      job_ = job;
    }
    if (actions.record) {
      require(actions.record->samples.size() == static_cast<std::size_t>(actions.record->settings.bins),
              "a record holds a whole line");
    }
    require(!actions.cancelled || (job_ && job_->number == *actions.cancelled), "what is cancelled is out");
    const auto& counters = device_.counters();
    require(counters.lines_sent + counters.pings_failed + counters.pings_cancelled <= counters.pings_started,
            "every line has its ping");
    require(!actions.wake_at || *actions.wake_at > now_, "the next deadline is later than now");
    wake_at_ = actions.wake_at;
  }

  void answer_job(bool rendered) {
    if (!job_) {
      return;
    }
    const PingJob job = *job_;
    job_.reset();
    if (rendered) {
      step(sonard::PingRendered{
          PingImage{job.number, std::vector<std::uint8_t>(static_cast<std::size_t>(job.bins()), 77), {}}});
    } else {
      step(sonard::PingNotRendered{job.number});
    }
  }

  TimePoint now_{};
  Device device_{DeviceConfig{}, now_};
  std::optional<TimePoint> wake_at_;
  std::optional<PingJob> job_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bench bench;
  for (Script script{{data, size}, byte_kinds}; !script.done();) {
    bench.play(script.next());
  }
  return 0;
}
