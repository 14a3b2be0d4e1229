// SPDX-License-Identifier: Apache-2.0
// Plays a trajectory to a pose link.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "clients/posecast/pose_link.hpp"
#include "protocol/pose/trajectory.hpp"

namespace sonard::client {

struct CastSettings {
  pose::Playback playback;
  double rate_hz = 50.0;                             ///< poses per second by their stamps, > 0
  bool twist = true;                                 ///< also send velocities
  std::optional<std::chrono::nanoseconds> duration;  ///< by the stamps; nullopt: until the trajectory ends
  /// True: stamps from the trajectory; playback.speed sets how fast they pass. False: stamps are the times of
  /// the ticks on std::chrono::steady_clock.
  bool stamps_of_file = false;
  /// Real time during which only the first pose is sent, repeatedly.
  std::chrono::nanoseconds hold{};
};

/// Sends a pose at each tick of a fixed rate, interpolated between the points of the trajectory.
///
/// With stamps of the clock, missed ticks are skipped (the process was suspended, or the receiver blocked).
/// With stamps of the file, no tick is skipped: each run sends the same poses, and the caster waits for a
/// blocked receiver. In a loop, these stamps continue to rise.
class Caster {
 public:
  /// All arguments must outlive the caster.
  Caster(boost::asio::io_context& io, const pose::Trajectory& trajectory, const CastSettings& settings,
         PoseLink& link);
  ~Caster();

  /// Sends the first pose at once. Calls `on_end` after the last pose.
  void start(std::function<void()> on_end);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::client
