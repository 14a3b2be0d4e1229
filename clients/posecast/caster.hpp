// SPDX-License-Identifier: Apache-2.0
// Plays a trajectory into a pose link.
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
  double rate_hz = 50.0;                             ///< poses per second of the stamps, > 0
  bool twist = true;                                 ///< say how the vehicle moves
  std::optional<std::chrono::nanoseconds> duration;  ///< of the stamps; without it, until the trajectory ends
  /// True: stamps are those of the trajectory, and playback.speed changes how fast they pass. False: stamps
  /// are those of the ticks on std::chrono::steady_clock.
  bool stamps_of_file = false;
  /// So long of real time the first pose is sent again and again before the others.
  std::chrono::nanoseconds hold{};
};

/// Sends a pose at every tick of a fixed rate, interpolated between the points of the trajectory.
///
/// With stamps of the clock, ticks that were missed (a suspended process, a receiver that does not read) are
/// left out. With stamps of the file none is left out: every run sends the same poses, and a receiver that
/// does not read makes the caster wait. In a loop these stamps go on rising.
class Caster {
 public:
  /// Everything given outlives the caster.
  Caster(boost::asio::io_context& io, const pose::Trajectory& trajectory, const CastSettings& settings,
         PoseLink& link);
  ~Caster();

  /// Sends the first pose at once; `on_end` is called when all is sent.
  void start(std::function<void()> on_end);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::client
