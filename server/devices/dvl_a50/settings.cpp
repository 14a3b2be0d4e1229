// SPDX-License-Identifier: Apache-2.0
#include "server/devices/dvl_a50/settings.hpp"

#include <numbers>

#include "server/devices/directions.hpp"

namespace sonard::server {

// Widths and frequencies from the maker's product pages (protocol/dvl_a50/README.md 3).
double dvl_carrier_hz(dvl_a50::Model model) {
  return model == dvl_a50::Model::a50 ? 1e6 : 420e3;
}

render::SonarSettings dvl_acoustics(dvl_a50::Model model) {
  constexpr double degree = std::numbers::pi / 180.0;
  render::SonarSettings acoustics;
  acoustics.aperture.receive_beamwidth_rad = (model == dvl_a50::Model::a50 ? 4.4 : 4.1) * degree;
  return acoustics;
}

render::SonarSettings dvl_sonar_settings(const PingJob& job, const HeadConfig& head) {
  render::SonarSettings settings = head.acoustics;
  const double width_rad = head.acoustics.aperture.receive_beamwidth_rad;
  if (job.directions.any()) {
    set_directions(job, width_rad, width_rad, settings);
  } else {  // a recorded ping, which is not rendered
    settings.aperture.beam_edges_rad = {width_rad / 2, -width_rad / 2};
    settings.range = {.count = job.native_bins, .step_m = job.native_bin_m};
  }
  return settings;
}

}  // namespace sonard::server
