// SPDX-License-Identifier: Apache-2.0
// Recorded motion: parser for trajectory files, and playback. docs/poses.md describes the two formats.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/pose/pose_codec.hpp"
#include "protocol/pose/transform.hpp"

namespace sonard::pose {

/// A trajectory that cannot be used. what() is one line: "file:line: message".
struct TrajectoryError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct TrajectoryPoint {
  std::int64_t time_ns = 0;
  Transform T_world_vehicle;
};

/// Pose and twist of the vehicle at one time of a trajectory.
struct TrajectoryState {
  Transform T_world_vehicle;
  Velocity twist;  ///< in the vehicle's axes; zero before the first point and from the last point on
};

/// One or more points with strictly increasing times.
class Trajectory {
 public:
  /// `points` must not be empty and must have strictly increasing times.
  explicit Trajectory(std::vector<TrajectoryPoint> points);

  std::int64_t start_ns() const { return points_.front().time_ns; }
  std::int64_t end_ns() const { return points_.back().time_ns; }
  const std::vector<TrajectoryPoint>& points() const { return points_; }

  /// Interpolates between points: position on a straight line, orientation on the shortest arc. Before the
  /// first and after the last point the vehicle rests at that point.
  TrajectoryState at(std::int64_t time_ns) const;

 private:
  std::vector<TrajectoryPoint> points_;
};

/// Reads CSV (first line `t,x,y,z,qx,qy,qz,qw`) or TUM (`t x y z qx qy qz qw`); `#` starts a comment line.
/// Times in seconds, positions in metres, in `axes`. Errors contain the name `file`.
/// @throws TrajectoryError for any other text: a bad number, a wrong number of columns, NaN, an invalid
/// quaternion, times that do not increase, or no points
Trajectory parse_trajectory(std::string_view text, const std::string& file, Axes axes = Axes::enu_flu);
/// Reads a trajectory from a file.
/// @throws TrajectoryError also if the file cannot be read
Trajectory load_trajectory(const std::filesystem::path& file, Axes axes = Axes::enu_flu);

/// Playback settings of a trajectory.
struct Playback {
  double speed = 1.0;        ///< > 0; 2: twice as fast as recorded
  bool loop = false;         ///< jump from the end to the start and continue
  std::int64_t from_ns = 0;  ///< starts this long after the first point, >= 0
};

/// True if playback has reached the end after `elapsed`; never in a loop.
bool finished(const Trajectory& trajectory, const Playback& playback, std::chrono::nanoseconds elapsed);

/// The sample after playing for `elapsed` (>= 0). Its twist is scaled by the playback speed, and missing if
/// it exceeds max_speed. The caller sets `time_ns` from its own clock.
PoseSample play(const Trajectory& trajectory, const Playback& playback, std::chrono::nanoseconds elapsed);

}  // namespace sonard::pose
