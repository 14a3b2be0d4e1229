// SPDX-License-Identifier: Apache-2.0
#include "server/pose/pose_track.hpp"

#include <algorithm>
#include <iterator>

namespace sonard::server {
namespace {

constexpr double seconds_per_ns = 1e-9;

/// True if a body that moves from one point to the other is too fast for one that was not moved.
bool was_moved(const TrackPoint& from, const TrackPoint& to) {
  const double span_s = seconds_per_ns * static_cast<double>(to.time_ns - from.time_ns);
  const double step_m = pose::norm(to.T_world_body.position_m - from.T_world_body.position_m);
  return step_m > PoseTrack::teleport_mps * span_s;
}

pose::Transform between(const TrackPoint& from, const TrackPoint& to, std::int64_t time_ns) {
  const double span_s = seconds_per_ns * static_cast<double>(to.time_ns - from.time_ns);
  if (was_moved(from, to)) {
    return from.T_world_body;
  }
  const double passed_s = seconds_per_ns * static_cast<double>(time_ns - from.time_ns);
  return pose::interpolate(from.T_world_body, to.T_world_body, passed_s / span_s);
}

/// The twist at `fraction` of the motion from one point to the other.
pose::Velocity twist_between(const TrackPoint& from, const TrackPoint& to, double fraction) {
  if (was_moved(from, to)) {
    return {};
  }
  if (from.twist && to.twist) {
    const auto mixed = [fraction](const pose::Vec3& a, const pose::Vec3& b) {
      return a + fraction * (b - a);
    };
    return {mixed(from.twist->linear_mps, to.twist->linear_mps),
            mixed(from.twist->angular_radps, to.twist->angular_radps)};
  }
  const double per_second = 1.0 / (seconds_per_ns * static_cast<double>(to.time_ns - from.time_ns));
  const pose::Transform there = pose::interpolate(from.T_world_body, to.T_world_body, fraction);
  const pose::Quat turn = pose::conjugate(from.T_world_body.orientation) * to.T_world_body.orientation;
  return {pose::rotate(pose::conjugate(there.orientation),
                       per_second * (to.T_world_body.position_m - from.T_world_body.position_m)),
          per_second * pose::to_rotation_vector(turn)};
}

}  // namespace

PoseTrack::Placed PoseTrack::insert(const TrackPoint& point) {
  const auto place =
      std::lower_bound(points_.begin(), points_.end(), point.time_ns,
                       [](const TrackPoint& p, std::int64_t time_ns) { return p.time_ns < time_ns; });
  if (place != points_.end() && place->time_ns == point.time_ns) {
    *place = point;
    return Placed::replaced;
  }
  const bool full = points_.size() == capacity_;
  if (full && place == points_.begin()) {
    return Placed::too_old;
  }
  const Placed placed = place == points_.end() ? Placed::newest : Placed::between;
  points_.insert(place, point);
  if (full) {
    points_.pop_front();
  }
  return placed;
}

std::optional<std::int64_t> PoseTrack::known_from(std::int64_t time_ns, std::int64_t gap_ns) const {
  const auto next = std::lower_bound(points_.begin(), points_.end(), time_ns,
                                     [](const TrackPoint& p, std::int64_t t) { return p.time_ns < t; });
  if (next == points_.end()) {
    return std::nullopt;
  }
  const bool first = next == points_.begin();
  return first || next->time_ns - std::prev(next)->time_ns > gap_ns ? next->time_ns : time_ns;
}

pose::Transform PoseTrack::at(std::int64_t time_ns, std::int64_t limit_ns) const {
  const auto later = std::upper_bound(points_.begin(), points_.end(), time_ns,
                                      [](std::int64_t t, const TrackPoint& p) { return t < p.time_ns; });
  if (later == points_.begin()) {
    return points_.front().T_world_body;
  }
  const TrackPoint& before = *std::prev(later);
  if (later != points_.end()) {
    return between(before, *later, time_ns);
  }
  if (!before.twist) {
    return before.T_world_body;
  }
  const std::int64_t past_ns = std::min(time_ns - before.time_ns, limit_ns);
  return pose::advance(before.T_world_body, *before.twist, seconds_per_ns * static_cast<double>(past_ns));
}

pose::Velocity PoseTrack::twist_at(std::int64_t time_ns, std::int64_t limit_ns) const {
  const auto later = std::upper_bound(points_.begin(), points_.end(), time_ns,
                                      [](std::int64_t t, const TrackPoint& p) { return t < p.time_ns; });
  if (later == points_.begin()) {
    return points_.front().twist.value_or(pose::Velocity{});
  }
  const TrackPoint& before = *std::prev(later);
  if (later != points_.end()) {
    return twist_between(
        before, *later,
        static_cast<double>(time_ns - before.time_ns) / static_cast<double>(later->time_ns - before.time_ns));
  }
  if (time_ns - before.time_ns > limit_ns) {
    return {};
  }
  if (before.twist || points_.size() < 2) {
    return before.twist.value_or(pose::Velocity{});
  }
  const TrackPoint& last_but_one = points_[points_.size() - 2];
  return before.time_ns - last_but_one.time_ns <= limit_ns ? twist_between(last_but_one, before, 1.0)
                                                           : pose::Velocity{};
}

}  // namespace sonard::server
