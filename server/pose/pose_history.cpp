// SPDX-License-Identifier: Apache-2.0
#include "server/pose/pose_history.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>

#include "server/pose/to_render.hpp"

namespace sonard::server {
namespace {

/// Local networks are faster than 50 ms, and a slow clock must not use up the extrapolation limit.
std::chrono::nanoseconds longest_delay(std::chrono::nanoseconds extrapolation_limit) {
  return std::min<std::chrono::nanoseconds>(std::chrono::milliseconds{50}, extrapolation_limit / 2);
}

std::size_t points_kept(PingClock clock, std::size_t by_wall_clock) {
  switch (clock) {
    case PingClock::wall:
      break;
    case PingClock::simulated:
      return PoseHistory::simulated_points;
    case PingClock::simulated_lock_step:
      return PoseHistory::lock_step_points;
  }
  return by_wall_clock;
}

}  // namespace

std::string stale_text(const StalePose& pose) {
  return fmt::format(
      "the pose is stale: the newest one is {:.1f} s old, and poses.extrapolation_limit_ms allows {:g} ms",
      1e-9 * static_cast<double>(pose.age.count()), 1e-6 * static_cast<double>(pose.limit.count()));
}

PoseHistory::PoseHistory(const PoseConfig& config)
    : initial_(config.T_world_vehicle_initial),
      limit_(config.extrapolation_limit),
      stale_policy_(config.stale_policy),
      ping_clock_(config.clock),
      clock_(longest_delay(config.extrapolation_limit)),
      vehicle_(points_kept(config.clock, vehicle_points)) {}

void PoseHistory::insert(const pose::PoseSample& sample, TimePoint arrival) {
  restart_if_clock_went_back(sample.time_ns);
  clock_.observe(sample.time_ns, arrival);
  ++counters_.samples;
  count(vehicle_.insert({sample.time_ns, sample.T_world_vehicle, sample.twist}));
  for (const pose::NamedTransform& body : sample.bodies) {
    insert_body(body, sample.time_ns);
  }
}

bool PoseHistory::would_restart(std::int64_t time_ns) const {
  return !vehicle_.empty() && time_ns < vehicle_.newest().time_ns - reset_threshold.count();
}

void PoseHistory::restart_if_clock_went_back(std::int64_t time_ns) {
  if (!would_restart(time_ns)) {
    return;
  }
  ++counters_.clock_restarts;
  if (std::has_single_bit(counters_.clock_restarts)) {
    const double back_s = 1e-9 * static_cast<double>(vehicle_.newest().time_ns - time_ns);
    spdlog::warn("pose stream: its clock went back by {:.3f} s, older poses dropped ({} so far)", back_s,
                 counters_.clock_restarts);
  }
  clock_.restart();
  vehicle_.clear();
  bodies_.clear();
}

void PoseHistory::count(PoseTrack::Placed placed) {
  counters_.late += placed == PoseTrack::Placed::between ? 1 : 0;
  counters_.repeated += placed == PoseTrack::Placed::replaced ? 1 : 0;
  counters_.too_old += placed == PoseTrack::Placed::too_old ? 1 : 0;
}

void PoseHistory::insert_body(const pose::NamedTransform& body, std::int64_t time_ns) {
  auto track = bodies_.find(body.name);
  if (track == bodies_.end()) {
    if (bodies_.size() == max_bodies) {
      if (++counters_.bodies_ignored == 1) {
        spdlog::warn("pose stream: more than {} bodies, '{}' and later ones are ignored", max_bodies,
                     body.name);
      }
      return;
    }
    track = bodies_.emplace(body.name, PoseTrack{points_kept(ping_clock_, body_points)}).first;
  }
  track->second.insert({time_ns, body.T_world_body, body.twist});
}

std::optional<PoseEstimate> PoseHistory::at(TimePoint time) const {
  if (vehicle_.empty()) {
    return initial_ ? std::optional{PoseEstimate{*initial_, PoseQuality::initial, {}}} : std::nullopt;
  }
  if (stale_at(time)) {
    return std::nullopt;
  }
  const std::int64_t time_ns = stamp_at(time);
  const std::chrono::nanoseconds age{time_ns - vehicle_.newest().time_ns};
  PoseEstimate estimate{to_render(vehicle_.at(time_ns, limit_.count())), PoseQuality::interpolated,
                        std::max(age, std::chrono::nanoseconds{0})};
  if (age > limit_) {
    estimate.quality = PoseQuality::stale;
  } else if (age > std::chrono::nanoseconds{0}) {
    estimate.quality = vehicle_.newest().twist ? PoseQuality::extrapolated : PoseQuality::held;
  } else if (time_ns < vehicle_.oldest().time_ns) {
    estimate.quality = PoseQuality::held;
  }
  return estimate;
}

pose::Velocity PoseHistory::twist_at(TimePoint time) const {
  return vehicle_.empty() ? pose::Velocity{} : vehicle_.twist_at(stamp_at(time), limit_.count());
}

std::optional<StalePose> PoseHistory::stale_at(TimePoint time) const {
  if (vehicle_.empty() || stale_policy_ != StalePolicy::silence) {
    return std::nullopt;
  }
  const std::chrono::nanoseconds age{stamp_at(time) - vehicle_.newest().time_ns};
  return age > limit_ ? std::optional(StalePose{age, limit_}) : std::nullopt;
}

TimePoint PoseHistory::present(TimePoint now) const {
  return ping_clock_ == PingClock::wall || vehicle_.empty() ? now : TimePoint{vehicle_.newest().time_ns};
}

std::int64_t PoseHistory::stamp_at(TimePoint time) const {
  if (vehicle_.empty()) {
    return 0;
  }
  return ping_clock_ == PingClock::wall ? clock_.stamp_at(time) : time.count();
}

std::optional<TimePoint> PoseHistory::oldest() const {
  return vehicle_.empty() ? std::nullopt : std::optional{TimePoint{vehicle_.oldest().time_ns}};
}

std::optional<TimePoint> PoseHistory::newest() const {
  return vehicle_.empty() ? std::nullopt : std::optional{TimePoint{vehicle_.newest().time_ns}};
}

std::optional<TimePoint> PoseHistory::known_from(TimePoint time) const {
  const auto known = vehicle_.empty() ? std::nullopt : vehicle_.known_from(time.count(), limit_.count());
  return known ? std::optional{TimePoint{*known}} : std::nullopt;
}

std::vector<PosedBody> PoseHistory::bodies_at(TimePoint time) const {
  std::vector<PosedBody> posed;
  posed.reserve(bodies_.size());
  const std::int64_t time_ns = stamp_at(time);
  for (const auto& [name, track] : bodies_) {
    posed.push_back({name, to_render(track.at(time_ns, limit_.count()))});
  }
  return posed;
}

}  // namespace sonard::server
