// SPDX-License-Identifier: Apache-2.0
// The rendering of a head's pings, with counts and log lines.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/common/ping_job.hpp"
#include "renderer/pose.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/config/config.hpp"
#include "server/devices/head.hpp"
#include "server/devices/render_load.hpp"
#include "server/pose/posed_body.hpp"
#include "server/pose/simulated_ping_times.hpp"
#include "server/program_log/peer_log.hpp"
#include "server/recording/events.hpp"
#include "server/rendering/render_service.hpp"

namespace sonard::server {

/// Seconds of rendering, by stage.
struct StageSeconds {
  double visibility = 0.0, binning = 0.0, multipath = 0.0, azimuth_pattern = 0.0, pulse = 0.0, receiver = 0.0;

  StageSeconds& operator+=(const render::PingStatistics& ping);
};

/// Counters; they only grow.
struct RenderCounters {
  std::uint64_t pings_without_pose = 0;  ///< not rendered: no pose, or a stale one under StalePolicy::silence
  std::uint64_t pings_rendered = 0;
  double render_seconds = 0.0;  ///< all stages except multipath
  StageSeconds stages;
  render::SkipCounts skipped;  ///< of all pings
};

/// One ping of a head for the render thread.
struct PingToRender {
  std::uint64_t number = 0;
  TimePoint pose_time{};              ///< of the transmission, on the clock of PoseHistory
  std::uint64_t transmit_us = 0;      ///< on the head's clock
  std::chrono::nanoseconds period{};  ///< PingJob::period
  render::Pose T_world_sonar;
  std::optional<render::Pose> T_world_sonar_at_end;  ///< when the last echo returns; nullopt: not known
  render::SonarSettings settings;
};

/// Belongs to the I/O thread.
class HeadRendering {
 public:
  HeadRendering(const HeadConfig& config, int index, const HeadServices& services);

  /// Time of the poses, on the clock of PoseHistory, of a ping transmitted at this time of the head: the time
  /// that SimulatedPingTimes returned, or else the same time.
  TimePoint pose_time(TimePoint transmit_time) const { return ping_time_.value_or(transmit_time); }

  /// In simulated time: begins `next` if its poses have arrived. Returns true if it did.
  bool begin_ping(TimePoint now, const std::optional<NextPing>& next);
  /// In simulated time: no client requests pings.
  void rest();
  /// Longest time between two requests of a client that requests single pings. After that, the head counts as
  /// idle.
  static constexpr std::chrono::seconds longest_pause{3};
  /// See SimulatedPingTimes::lead().
  std::optional<std::chrono::nanoseconds> pose_lead() const;

  /// Pose of the head's mount in the world; for a future time, extrapolated by the twist of the newest pose.
  /// nullopt: there is no pose, or only a stale one that must not be used.
  std::optional<render::Pose> T_world_mount(TimePoint time) const;

  /// Bodies moved by the poses, including the vehicle's model unless it is hidden.
  std::vector<PosedBody> bodies_at(TimePoint time) const;

  /// All poses that a log stores for a ping transmitted at `transmit_time`; null if no pose is known.
  std::shared_ptr<const PosesUsed> poses_used(TimePoint transmit_time) const;

  void submit(PingToRender ping, RenderService::Done done);
  /// Counts an answer and logs its error, once per error. @return true if there are samples
  bool take(const RenderResult& result);
  /// SkipRule::nobody_listening: withdraws a ping that waits behind pings of other heads.
  bool withdraw();
  void count_missing_pose() { ++counters_.pings_without_pose; }

  const RenderCounters& counters() const { return counters_; }
  const render::PingStatistics& newest_statistics() const { return newest_; }

 private:
  void rest_when_idle(TimePoint now);

  const HeadConfig& config_;
  int index_;
  HeadServices services_;
  std::optional<SimulatedPingTimes> ping_times_;  ///< in simulated time
  std::optional<TimePoint> ping_time_;            ///< on that clock, of the ping that began last
  TimePoint last_wanted_{};                       ///< on the clock of this process
  bool submitted_ = false;                        ///< and not yet answered
  RenderLoad load_;
  RenderCounters counters_;
  render::PingStatistics newest_;
  std::string last_error_;
  PeerLog errors_;
};

/// Logs "head=NAME: skipped rule=count ..." at level debug, with every rule that has skipped something.
void log_skipped(const std::string& head, const render::SkipCounts& skipped);
/// Mean rendering time of a ping between two states of the counters, in milliseconds; 0 if there was no ping.
double mean_render_ms(const RenderCounters& before, const RenderCounters& now);

}  // namespace sonard::server
