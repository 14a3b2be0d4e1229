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
#include "server/pose/ping_times.hpp"
#include "server/pose/posed_body.hpp"
#include "server/program_log/peer_log.hpp"
#include "server/recording/events.hpp"
#include "server/rendering/render_service.hpp"

namespace sonard::server {

/// Seconds of rendering, by stage.
struct StageSeconds {
  double visibility = 0.0, binning = 0.0, multipath = 0.0, azimuth_pattern = 0.0, pulse = 0.0, receiver = 0.0;

  StageSeconds& operator+=(const render::PingStatistics& ping);
};

/// Counters, which only grow.
struct RenderCounters {
  std::uint64_t pings_without_pose = 0;  ///< not rendered: no pose, or a stale one under StalePolicy::silence
  std::uint64_t pings_rendered = 0;
  double render_seconds = 0.0;  ///< all of them together, ghosts and bounces apart
  StageSeconds stages;
  render::SkipCounts skipped;  ///< of all pings
};

/// One ping of a head for the render thread.
struct HeadPing {
  std::uint64_t number = 0;
  TimePoint pose_time{};              ///< of the transmission, as PoseHistory takes it
  std::uint64_t transmit_us = 0;      ///< of the clock of the head
  std::chrono::nanoseconds period{};  ///< PingJob::period
  render::Pose T_world_sonar;
  std::optional<render::Pose> T_world_sonar_at_end;  ///< when the last echo returns; nullopt: not known
  render::SonarSettings settings;
};

/// Belongs to the I/O thread, as its head does.
class HeadRendering {
 public:
  HeadRendering(const HeadConfig& config, int stream, const HeadServices& services);

  /// The time of a ping's poses, as PoseHistory takes it, that is transmitted at a time of the head's own:
  /// this, or what PingTimes said when it was granted.
  TimePoint pose_time(TimePoint transmit_time) const { return ping_time_.value_or(transmit_time); }

  /// With pings by the clock of the source: begins `next` if its poses are there. Returns whether it did.
  bool begin_ping(TimePoint now, const std::optional<NextPing>& next);
  /// With pings by the clock of the source: no client wants pings.
  void rest();
  /// Longest time between two requests of a client that asks for one ping after the other; after that no ping
  /// is wanted.
  static constexpr std::chrono::seconds longest_pause{3};
  /// See PingTimes::lead().
  std::optional<std::chrono::nanoseconds> pose_lead() const;

  /// Pose of the head's mount; of a future time, extrapolated by the twist of the newest pose. nullopt: there
  /// is no pose, or only a stale one that must not be used.
  std::optional<render::Pose> T_world_mount(TimePoint time) const;

  /// Bodies as the poses say, and with them the model of the vehicle, unless it is hidden.
  std::vector<PosedBody> bodies_at(TimePoint time) const;

  /// All poses that a log keeps of a ping transmitted at `transmit_time`.
  std::shared_ptr<const PosesUsed> poses_used(TimePoint transmit_time) const;

  void submit(HeadPing ping, RenderService::Done done);
  /// Counts an answer and logs an error in it, each error once. @return whether there are
  /// samples.
  bool take(const RenderResult& result);
  /// SkipRule::nobody_listening: takes back a ping that waits behind those of other heads.
  bool withdraw();
  void count_missing_pose() { ++counters_.pings_without_pose; }

  const RenderCounters& counters() const { return counters_; }
  /// Of the newest ping that was rendered.
  const render::PingStatistics& newest_statistics() const { return newest_; }

 private:
  void rest_when_idle(TimePoint now);

  const HeadConfig& config_;
  int stream_;
  HeadServices services_;
  std::optional<PingTimes> ping_times_;  ///< by the clock of the source
  std::optional<TimePoint> ping_time_;   ///< on that clock, of the ping that began last
  TimePoint last_wanted_{};              ///< on the clock of this machine
  bool submitted_ = false;               ///< and not answered
  RenderLoad load_;
  RenderCounters counters_;
  render::PingStatistics newest_;
  std::string last_error_;
  PeerLog errors_;
};

/// At level debug: "head=NAME skipped: rule=count ..." of every rule that has skipped something.
void log_skipped(const std::string& head, const render::SkipCounts& skipped);
/// Milliseconds of a mean ping between two states of the counters; 0 when there was none.
double mean_render_ms(const RenderCounters& before, const RenderCounters& now);

}  // namespace sonard::server
