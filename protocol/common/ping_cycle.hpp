// SPDX-License-Identifier: Apache-2.0
// The cycle of a head's pings, for all devices: when a ping may begin, its job, the answer, its end.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "protocol/common/device.hpp"

namespace sonard {

/// Counters of a head's pings. They only grow, also across reboots of the head.
struct PingCounters {
  std::uint64_t pings_started = 0;    ///< given out for rendering
  std::uint64_t pings_sent = 0;       ///< sent completely
  std::uint64_t pings_failed = 0;     ///< could not be rendered, or the image had the wrong size
  std::uint64_t pings_cancelled = 0;  ///< ended before they were sent completely
  std::uint64_t stale_images = 0;     ///< answers to unknown jobs, and images of cancelled pings

  std::uint64_t pings_ended() const { return pings_sent + pings_failed + pings_cancelled; }
};

/// The part of a Device that keeps its promises about jobs (Actions, PingRendered, PingFed, NextPingDue).
///
/// A ping is *under way* from begin() until put_on_wire(), fail() or cancel(). At most one ping is under way,
/// and it has one job. The job of a cancelled ping must be answered before the next ping can begin. What a
/// ping is, when it is wanted and when it is sent is up to the device.
class PingCycle {
 public:
  struct Config {
    bool simulated_time = false;  ///< each ping needs NextPingDue to begin
    bool plays_back = false;      ///< each ping sends a recorded ping, and needs PingFed to begin
  };

  /// The clock of the head is 0 at `boot_time`. `counters` must outlive the cycle. The cycle counts all but
  /// `pings_sent`, and pings that are cancelled on the wire.
  PingCycle(const Config& config, TimePoint boot_time, PingCounters& counters)
      : config_(config), counters_(counters), boot_time_(boot_time) {}

  /// Reboots the head: cancels the ping under way. Keeps the unanswered job and the count of jobs.
  void reboot(TimePoint boot_time);

  // ---- Before a ping

  /// PingFed. If the device cannot send `ping`, pass nullopt.
  void feed(std::optional<ReplayedPing> ping) { fed_ = std::move(ping); }
  /// The recorded ping that the next begin() consumes.
  const std::optional<ReplayedPing>& fed() const { return fed_; }
  /// NextPingDue.
  void grant() { granted_ = true; }

  /// Earliest transmit time of the next ping, if the client wants one. In simulated time this is `wanted`,
  /// because the server observes the rate. nullopt: a ping is under way, or an answer or PingFed is missing.
  /// @param wanted when the client requested the ping and the head was free for it
  /// @param by_rate not before this time by the ping rate
  std::optional<TimePoint> next_start(TimePoint wanted, TimePoint by_rate) const;
  /// False in simulated time until grant().
  bool granted() const { return granted_ || !config_.simulated_time; }

  // ---- The ping under way

  /// Begins a ping and consumes fed() and the grant. Requires next_start(). Sets the number, the times and
  /// the record of the job. Nothing else happens to the ping in this step, and report() requests its image.
  void begin(PingJob job, TimePoint transmit_time);
  /// Consumes the grant without a ping.
  void skip() { granted_ = false; }

  /// PingRendered. @return true if the image is for the ping under way. If its size is wrong, call fail().
  bool on_image(TimePoint now, std::uint64_t number);
  /// PingNotRendered. @return true if the ping under way has failed
  bool on_image_failed(TimePoint now, std::uint64_t number);

  /// The ping is sent from now on. Sets the number and the transmit time of its record.
  void put_on_wire(PingRecord record);
  void fail();
  /// Without effect if no ping is under way.
  void cancel();

  /// True if a ping is under way or a job is unanswered: no ping can begin.
  bool busy() const { return under_way_ || unanswered_; }
  bool under_way() const { return under_way_; }
  /// True if the ping under way has its image.
  bool rendered() const { return under_way_ && !unanswered_; }
  /// The newest job.
  const PingJob& job() const { return job_; }
  /// When the newest answer came; 0 before the first one.
  TimePoint answered_at() const { return answered_at_; }

  /// Sets `render`, `record` and `cancelled`. Call it once at the end of each step.
  void report(Actions& actions);

 private:
  bool answer(TimePoint now, std::uint64_t number);

  const Config config_;
  PingCounters& counters_;
  TimePoint boot_time_;
  std::optional<ReplayedPing> fed_;
  bool granted_ = false;
  bool under_way_ = false;
  PingJob job_;
  bool job_is_new_ = false;  ///< not reported yet
  std::uint64_t next_number_ = 0;
  std::optional<std::uint64_t> unanswered_;  ///< number of the job without an answer
  TimePoint answered_at_{};
  std::optional<PingRecord> record_;  ///< not reported yet
};

}  // namespace sonard
