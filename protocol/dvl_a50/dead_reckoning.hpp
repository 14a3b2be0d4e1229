// SPDX-License-Identifier: Apache-2.0
// Position and attitude relative to the vehicle frame at the last reset (4).
#pragma once

#include <chrono>
#include <optional>

#include "protocol/dvl_a50/motion.hpp"
#include "protocol/dvl_a50/noise.hpp"

namespace sonard::dvl_a50 {

struct DeadReckoningConfig {
  double heading_drift_radps = 0.0;
  /// Growth of the error of a moving vehicle: metres per square root of a second; ten times as much without
  /// bottom lock.
  double noise_m = 0.0;
};

class DeadReckoning {
 public:
  DeadReckoning(const DeadReckoningConfig& config, std::uint64_t seed) : config_(config), noise_(seed) {}

  void reset();
  /// Goes on with the motion of the vehicle at a time. Between two times the velocity is the mean of both; if
  /// the time goes backwards, as that of a restarted simulation, the vehicle stays where it is.
  void move(std::chrono::nanoseconds now, const Motion& vehicle, bool bottom_lock);
  /// Without a time.
  Position position() const;

 private:
  const DeadReckoningConfig config_;
  Noise noise_;
  std::optional<std::chrono::nanoseconds> moved_at_;
  Matrix start_{};     ///< Motion::axes at the reset
  Matrix axes_{};      ///< of the vehicle, in its frame at the reset
  Vector velocity_{};  ///< in that frame
  Vector position_{};
  double variance_ = 0.0;
  double drift_rad_ = 0.0;
};

}  // namespace sonard::dvl_a50
