// SPDX-License-Identifier: Apache-2.0
// Recorded motion: the text of a trajectory file, and playing it. docs/poses.md describes the two formats.
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

/// Where the vehicle is at an instant of a trajectory, and how it moves.
struct TrajectoryState {
  Transform T_world_vehicle;
  Velocity twist;  ///< in the vehicle's axes; zero from the last point on, and before the first
};

/// One or more points in strictly rising time.
class Trajectory {
 public:
  /// `points` is not empty and in strictly rising time.
  explicit Trajectory(std::vector<TrajectoryPoint> points);

  std::int64_t start_ns() const { return points_.front().time_ns; }
  std::int64_t end_ns() const { return points_.back().time_ns; }
  const std::vector<TrajectoryPoint>& points() const { return points_; }

  /// Between points, position goes on a straight line and orientation on the shortest arc; before the first
  /// and after the last point the vehicle rests there.
  TrajectoryState at(std::int64_t time_ns) const;

 private:
  std::vector<TrajectoryPoint> points_;
};

/// Reads CSV (first line `t,x,y,z,qx,qy,qz,qw`) or TUM (`t x y z qx qy qz qw`); `#` starts a comment line.
/// Time in seconds, positions in metres, in the axes of `axes`. `file` names the text in errors.
/// @throws TrajectoryError for anything else: a bad number, a number too many or too few, NaN, no rotation,
/// time that does not rise, no point at all.
Trajectory parse_trajectory(std::string_view text, const std::string& file, Axes axes = Axes::enu_flu);
/// Reads a trajectory from a file.
/// @throws TrajectoryError also when the file cannot be read.
Trajectory load_trajectory(const std::filesystem::path& file, Axes axes = Axes::enu_flu);

/// How a trajectory is played.
struct Playback {
  double speed = 1.0;        ///< > 0; 2: twice as fast as recorded
  bool loop = false;         ///< after the end from the start again, by a jump
  std::int64_t from_ns = 0;  ///< starts this long after the first point, >= 0
};

/// True when `elapsed` is past the end, which never happens in a loop.
bool finished(const Trajectory& trajectory, const Playback& playback, std::chrono::nanoseconds elapsed);

/// What a publisher says after playing for `elapsed` (>= 0), with twist (that of the playback, so it grows
/// with the speed). `time_ns` is left for the caller, whose clock it is.
PoseSample play(const Trajectory& trajectory, const Playback& playback, std::chrono::nanoseconds elapsed);

}  // namespace sonard::pose
