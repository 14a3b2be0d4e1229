// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes, lines, faults, recorded lines and pauses against a Micron head.
// Promises: every frame sent is a whole message of this head; the next deadline lies in the future; no more
// lines than requested; time goes on with any input.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/device.hpp"
#include "protocol/micron/recorded_form.hpp"
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

class Bench {
 public:
  explicit Bench(unsigned flags) : config_(config_of(flags)) { step(sonard::TimePassed{}); }

  void play(const Event& event) {
    run_until(now_ + event.delay);
    switch (event.kind) {
      case feed:
        feed_line(event);
        break;
      case next_due:
        if (last_.next_ping && last_.next_ping->from <= now_) {
          step(sonard::NextPingDue{});
        }
        break;
      case client_gone:
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
        receive(event);
    }
  }

 private:
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

  void run_until(TimePoint target) {
    constexpr int most_wake_ups = 1000;
    for (int i = 0; i < most_wake_ups && last_.wake_at && *last_.wake_at <= target; ++i) {
      now_ = std::max(now_, *last_.wake_at);
      step(sonard::TimePassed{});
    }
    now_ = target;
    step(sonard::TimePassed{});
  }

  void step(const sonard::Event& event) {
    last_ = device_.step(now_, event);
    for (const Outgoing& outgoing : last_.send) {
      const std::span<const std::uint8_t> frame{outgoing.bytes};
      require(outgoing.to == Outgoing::To::everybody, "all clients share the line");
      require(next_frame(frame, max_report_frame_size) == static_cast<std::ptrdiff_t>(frame.size()),
              "one whole frame at a time");
      const FrameHeader header = frame_header(frame);
      require(header.tx_node == default_head_node && header.rx_node == client_node,
              "a head signs its frames");
      const auto report = decode_report(frame);
      require(report.has_value() && !std::holds_alternative<Unknown>(*report),
              "a head speaks its own protocol");
    }
    if (last_.render) {
      const PingJob& job = *last_.render;
      require(!job_.has_value(), "one job at a time");
      require(job.bins() >= 1 && job.bins() <= max_bins, "a job can be rendered");
      constexpr double half_a_turn = std::numbers::pi + 1e-9;  // with rounding
      require(std::abs(job.bearing_rad) <= half_a_turn, "a job has a bearing of one turn");
      require(job.transmit_time <= now_, "a job is not ahead of its time");
      require(!config_.plays_back || job.record.has_value(), "a player renders nothing");
      job_ = job;
    }
    if (last_.record) {
      require(last_.record->samples.size() == static_cast<std::size_t>(last_.record->settings.bins),
              "a record holds a whole line");
      require(recorded_line(last_.record->wire).has_value(), "a record can be played");
    }
    require(!last_.cancelled || (job_ && job_->number == *last_.cancelled), "what is cancelled is out");
    const auto& counters = device_.counters();
    require(counters.pings_sent + counters.pings_failed + counters.pings_cancelled <= counters.pings_started,
            "every line has its ping");
    require(!last_.wake_at || *last_.wake_at > now_, "the next deadline is later than now");
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
  DeviceConfig config_;
  Device device_{config_, now_};
  Actions last_;
  std::optional<PingJob> job_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  Bench bench(data[0]);
  for (Script script{{data + 1, size - 1}, byte_kinds}; !script.done();) {
    bench.play(script.next());
  }
  return 0;
}
