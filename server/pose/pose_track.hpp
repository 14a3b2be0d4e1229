// SPDX-License-Identifier: Apache-2.0
// The recent motion of one body on the publisher's clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "protocol/pose/transform.hpp"

namespace sonard::server {

struct TrackPoint {
  std::int64_t time_ns = 0;
  pose::Transform T_world_body;
  std::optional<pose::Velocity> twist;  ///< in the axes of the body
};

/// Bounded: the oldest points make room for new ones.
class PoseTrack {
 public:
  /// `capacity` >= 1.
  explicit PoseTrack(std::size_t capacity) : capacity_(capacity) {}

  enum class Placed {
    newest,
    between,   ///< older than the newest: it came late
    replaced,  ///< same time as a point there was: the later word counts
    too_old,   ///< older than all points of a full track: dropped
  };
  /// Points may come in any order.
  Placed insert(const TrackPoint& point);
  void clear() { points_.clear(); }

  bool empty() const { return points_.empty(); }
  std::size_t size() const { return points_.size(); }
  /// Must not be empty.
  const TrackPoint& newest() const { return points_.back(); }
  const TrackPoint& oldest() const { return points_.front(); }

  /// The pose at a time; must not be empty. Between two points by interpolation, unless the body would have
  /// gone faster than teleport_mps: it has then been put elsewhere, and stays where it was until the time of
  /// the later point. After the newest point along its twist for at most `limit_ns`, at rest without a twist.
  /// Before the oldest point: the pose of that point.
  pose::Transform at(std::int64_t time_ns, std::int64_t limit_ns) const;

  /// The earliest time from `time_ns` on that is at a point, or between two that are at most `gap_ns` apart;
  /// nullopt: after the newest point. Must not be empty.
  std::optional<std::int64_t> known_from(std::int64_t time_ns, std::int64_t gap_ns) const;

  static constexpr double teleport_mps = 100.0;

 private:
  std::size_t capacity_;
  std::deque<TrackPoint> points_;  // in strictly rising time
};

}  // namespace sonard::server
