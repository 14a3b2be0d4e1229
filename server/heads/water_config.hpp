// SPDX-License-Identifier: Apache-2.0
// The section `water` of the configuration.
#pragma once

namespace sonard::server {

/// The water. Values derived from it (absorption, true speed of sound) are already in the heads' settings; it
/// is kept for the log and `sonard check`.
struct WaterConfig {
  double temperature_c = 10.0;
  double salinity_ppt = 35.0;
  double depth_m = 10.0;
  double ph = 8.0;
  double sound_speed_mps = 0.0;  ///< of this water (Mackenzie or Medwin), whether or not the heads use it
  /// Gradient of the speed of sound per metre upwards, 1/s. Positive: rays bend down; 0: rays are straight.
  double sound_speed_gradient_per_s = 0.0;
};

}  // namespace sonard::server
