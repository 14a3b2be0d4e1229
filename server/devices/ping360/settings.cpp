// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping360/settings.hpp"

#include <algorithm>

namespace sonard::server {

render::SonarSettings ping360_sonar_settings(const PingJob& job, const HeadConfig& head) {
  render::SonarSettings settings = head.acoustics;
  settings.range = {.count = std::max(1, job.native_bins),
                    .step_m = job.native_bins > 0 ? job.native_bin_m : 0.01,
                    .compression_log2 = 0,
                    .compression_peak = false};
  settings.transmit = job.transmit;
  settings.physical.range_cell_m = job.sound_speed_mps * job.pulse_s / 2.0;
  settings.physical.gain_db += job.gain_db;
  return settings;
}

}  // namespace sonard::server
