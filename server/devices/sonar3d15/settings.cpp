// SPDX-License-Identifier: Apache-2.0
#include "server/devices/sonar3d15/settings.hpp"

#include <cstddef>
#include <numbers>

#include "server/devices/directions.hpp"

namespace sonard::server {

render::SonarSettings sonar3d15_sonar_settings(const PingJob& job, const HeadConfig& head) {
  const Sonar3d15Config& config = device_settings<Sonar3d15Config>(head);
  const Sonar3d15ModeAcoustics& mode = config.modes.at(static_cast<std::size_t>(job.mode));
  render::SonarSettings settings = head.acoustics;
  settings.physical.absorption_db_per_m = mode.absorption_db_per_m;
  if (job.directions.any()) {
    set_directions(job, mode.horizontal_beamwidth_rad, mode.vertical_beamwidth_rad, settings);
  } else {  // a recorded shot, which is not rendered
    const double half_rad = config.device.mode(job.mode == 1).horizontal_fov_deg * std::numbers::pi / 360.0;
    settings.aperture.beam_edges_rad = {half_rad, -half_rad};
    settings.range = {.count = job.native_bins, .step_m = job.native_bin_m};
  }
  return settings;
}

}  // namespace sonard::server
