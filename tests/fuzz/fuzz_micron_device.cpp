// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes, lines, faults and pauses against a Micron head.
// Promises: every frame that leaves is a whole message of a head, from this head; the next deadline lies in
// the future; no more lines than were asked for; time goes on whatever comes in.
#include <optional>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/device.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace {

using namespace sonard::micron;
using sonard::fuzz::Event;
using sonard::fuzz::require;
using sonard::fuzz::Script;

/// Kinds of events. The first carries bytes: type and data of a frame, or a piece of stream as it is.
enum Kind { byte_kinds = 1, host_gone = 1, power_cycle = 2, lose_step = 3, line = 4, line_failed = 5 };

class Bench {
 public:
  void play(const Event& event) {
    run_until(now_ + event.delay);
    switch (event.kind) {
      case host_gone:
        device_.on_host_gone();
        break;
      case power_cycle:
        device_.power_cycle(now_);
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
    advance();
  }

 private:
  void hear(const Event& event) {
    if (event.as_is || event.datagram.empty()) {
      device_.on_bytes(now_, event.datagram);
    } else {
      device_.on_bytes(
          now_, frame_to_head(default_head_node, event.datagram[0], std::span{event.datagram}.subspan(1)));
    }
  }

  void run_until(TimePoint target) {
    constexpr int most_wake_ups = 1000;
    for (int i = 0; i < most_wake_ups; ++i) {
      const auto deadline = device_.next_deadline();
      if (!deadline || *deadline > target) {
        break;
      }
      now_ = std::max(now_, *deadline);
      advance();
    }
    now_ = target;
    advance();
  }

  void advance() {
    device_.advance(now_);
    for (const auto& frame : device_.take_outgoing()) {
      require(next_frame(frame, max_report_frame_size) == static_cast<std::ptrdiff_t>(frame.size()),
              "one whole frame at a time");
      const FrameHeader header = frame_header(frame);
      require(header.tx_node == default_head_node && header.rx_node == host_node, "a head signs its frames");
      const auto report = decode_report(frame);
      require(report.has_value() && !std::holds_alternative<Unknown>(*report),
              "a head speaks its own protocol");
    }
    if (auto job = device_.take_job()) {
      require(!job_.has_value(), "one job at a time");
      require(job->bins >= 1 && job->bins <= max_bins && job->bearing < 6400, "a job can be rendered");
      require(job->transmit_time <= now_, "a job is not ahead of its time");
      job_ = *job;
    }
    const auto& counters = device_.counters();
    require(counters.lines_sent + counters.pings_failed + counters.pings_cancelled <= counters.pings_started,
            "every line has its ping");
    const auto deadline = device_.next_deadline();
    require(!deadline || *deadline > now_, "the next deadline is later than now");
  }

  void answer_job(bool rendered) {
    if (!job_) {
      return;
    }
    const MicronJob job = *job_;
    job_.reset();
    if (rendered) {
      device_.on_line(now_,
                      {job.ping_number, std::vector<std::uint8_t>(static_cast<std::size_t>(job.bins), 77)});
    } else {
      device_.on_line_failed(now_, job.ping_number);
    }
  }

  TimePoint now_{};
  Device device_{DeviceConfig{}, now_};
  std::optional<MicronJob> job_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bench bench;
  for (Script script{{data, size}, byte_kinds}; !script.done();) {
    bench.play(script.next());
  }
  return 0;
}
