// SPDX-License-Identifier: Apache-2.0
#include "server/devices/micron/settings.hpp"

#include "server/devices/single_beam.hpp"

namespace sonard::server {

render::SonarSettings micron_sonar_settings(const PingJob& job, const HeadConfig& head) {
  const MicronConfig& config = device_settings<MicronConfig>(head);
  render::SonarSettings settings = single_beam_settings(job, head);
  settings.physical.gain_db = head.acoustics.physical.gain_db + (job.gain_db - config.nominal_gain_db);
  if (config.chirp_bandwidth_hz > 0.0 && job.sound_speed_mps > 0.0) {
    settings.physical.pulse.range_cell_m = job.sound_speed_mps / (2.0 * config.chirp_bandwidth_hz);
  }
  return settings;
}

}  // namespace sonard::server
