// SPDX-License-Identifier: Apache-2.0
#include "server/devices/micron/settings.hpp"

#include <algorithm>

namespace sonard::server {

render::SonarSettings micron_sonar_settings(const PingJob& job, const HeadConfig& head) {
  const MicronConfig& config = device_settings<MicronConfig>(head);
  render::SonarSettings settings = head.acoustics;
  settings.range = {.count = std::max(1, job.native_bins),
                    .step_m = job.native_bins > 0 ? job.native_bin_m : 0.01,
                    .compression_log2 = 0,
                    .compression_peak = false};
  settings.transmit = job.transmit;
  settings.physical.gain_db += job.gain_db - config.nominal_gain_db;
  if (config.chirp_bandwidth_hz > 0.0 && job.sound_speed_mps > 0.0) {
    settings.physical.pulse.range_cell_m = job.sound_speed_mps / (2.0 * config.chirp_bandwidth_hz);
  }
  return settings;
}

}  // namespace sonard::server
