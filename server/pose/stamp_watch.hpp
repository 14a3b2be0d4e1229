// SPDX-License-Identifier: Apache-2.0
// Detects stamps that do not advance while the vehicle moves.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "protocol/pose/pose_codec.hpp"
#include "server/clock/clock.hpp"

namespace sonard::server {

/// Finds meaningless stamps: missing or rounded ones. Reads no clock; arrivals must not go backwards. In a
/// paused simulation stamps do not advance either, but the vehicle is at rest.
class StampWatch {
 public:
  enum class Looks : std::uint8_t {
    good,
    stand_still,  ///< no advance while the vehicle moves
    in_steps,     ///< no advance for many poses of a moving vehicle, then a jump, repeatedly
    never_moved,  ///< no advance since the first pose, and the vehicle has not moved
  };

  void observe(const pose::PoseSample& sample, TimePoint arrival);

  Looks looks() const;
  /// How long the stamps last stayed; for Looks::in_steps.
  std::chrono::nanoseconds last_step() const { return last_step_; }

 private:
  /// Consecutive poses with the same stamp.
  struct Run {
    pose::Transform first;
    std::int64_t time_ns = 0;
    std::size_t poses = 1;
    TimePoint begin{}, end{};  ///< arrivals of the first and the last pose
    bool moved = false;

    std::chrono::nanoseconds length() const { return end - begin; }
    bool of_a_moving_vehicle() const;
  };

  std::optional<Run> run_;
  std::size_t runs_before_ = 0;  ///< ended runs
  std::size_t steps_ = 0;        ///< consecutive newest ended runs of a moving vehicle
  std::chrono::nanoseconds last_step_{0};
};

}  // namespace sonard::server
