// SPDX-License-Identifier: Apache-2.0
// Whether the stamps of poses go on while the vehicle moves.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "protocol/pose/pose_codec.hpp"
#include "server/clock/clock.hpp"

namespace sonard::server {

/// Finds stamps that mean nothing: those that a publisher leaves out, or rounds. Reads no clock; arrivals do
/// not go backwards. A simulation that is paused has stamps that stand still, too, but its vehicle rests.
class StampWatch {
 public:
  enum class Looks : std::uint8_t {
    good,
    stand_still,  ///< while the vehicle moves
    in_steps,     ///< they stand still for many poses of a moving vehicle, then jump, again and again
    never_moved,  ///< since the first pose, whose place the vehicle has not left
  };

  void observe(const pose::PoseSample& sample, TimePoint arrival);

  Looks looks() const;
  /// How long the stamps stood still the last time; of Looks::in_steps.
  std::chrono::nanoseconds last_step() const { return last_step_; }

 private:
  /// Poses, one after the other, that have the same stamp.
  struct Run {
    pose::Transform first;
    std::int64_t time_ns = 0;
    std::size_t poses = 1;
    TimePoint begin{}, end{};  ///< arrivals of its first and its last pose
    bool moved = false;

    std::chrono::nanoseconds length() const { return end - begin; }
    bool of_a_moving_vehicle() const;
  };

  std::optional<Run> run_;
  std::size_t runs_before_ = 0;  ///< that have ended
  std::size_t steps_ = 0;        ///< the last of these that were of a moving vehicle
  std::chrono::nanoseconds last_step_{0};
};

}  // namespace sonard::server
