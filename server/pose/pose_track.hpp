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
  std::optional<pose::Velocity> twist;  ///< in the body's frame
};

/// Bounded: new points replace the oldest ones.
class PoseTrack {
 public:
  /// `capacity` >= 1.
  explicit PoseTrack(std::size_t capacity) : capacity_(capacity) {}

  enum class Placed {
    newest,
    between,   ///< older than the newest: it arrived late
    replaced,  ///< same time as an existing point, which it replaces
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

  /// The pose at a time; the track must not be empty. Between two points it is interpolated. If the body
  /// would be faster than teleport_mps, it was moved: it then stays at the earlier point until the time of
  /// the later one. After the newest point it follows its twist for at most `limit_ns`, or rests without a
  /// twist. Before the oldest point: the pose of that point.
  pose::Transform at(std::int64_t time_ns, std::int64_t limit_ns) const;

  /// The twist at a time, in the body's frame; the track must not be empty. Between two points: of their
  /// twists, or else of the motion from one to the other. After the newest point: its twist, or else that of
  /// the last two points if they are at most `limit_ns` apart; 0 after `limit_ns`. A body that was moved, as
  /// in at(), has no twist.
  pose::Velocity twist_at(std::int64_t time_ns, std::int64_t limit_ns) const;

  /// The earliest time, from `time_ns` on, that is at a point or between two points at most `gap_ns` apart;
  /// nullopt: after the newest point. The track must not be empty.
  std::optional<std::int64_t> known_from(std::int64_t time_ns, std::int64_t gap_ns) const;

  static constexpr double teleport_mps = 100.0;

 private:
  std::size_t capacity_;
  std::deque<TrackPoint> points_;  // in strictly increasing time
};

}  // namespace sonard::server
