// SPDX-License-Identifier: Apache-2.0
// Plays a trajectory into a pose link, in real time.
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
  double rate_hz = 50.0;                             ///< poses per second of real time, > 0
  bool twist = true;                                 ///< say how the vehicle moves
  std::optional<std::chrono::nanoseconds> duration;  ///< of real time; without it, until the trajectory ends
};

/// Sends a pose at every tick of a fixed rate, interpolated between the points of the trajectory; ticks that
/// were missed (a suspended process) are left out. Time stamps are those of the ticks on
/// std::chrono::steady_clock.
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
