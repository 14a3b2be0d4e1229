// SPDX-License-Identifier: Apache-2.0
#include "server/devices/single_beam.hpp"

#include <algorithm>
#include <numbers>

namespace sonard::server {

render::SonarSettings single_beam_acoustics(double width_deg, double height_deg) {
  constexpr double degree = std::numbers::pi / 180.0;
  render::SonarSettings acoustics;
  acoustics.aperture.beam_edges_rad = {width_deg / 2.0 * degree, -width_deg / 2.0 * degree};
  acoustics.aperture.receive_beamwidth_rad = width_deg * degree;
  acoustics.aperture.vertical_beamwidth_rad = height_deg * degree;
  acoustics.aperture.elevation = render::Aperture::Elevation::sinc_two_way;
  acoustics.physical.ring_down.on = true;
  acoustics.physical.noise.broadside_stripe_db = 0.0;
  return acoustics;
}

render::SonarSettings single_beam_settings(const PingJob& job, const HeadConfig& head) {
  render::SonarSettings settings = head.acoustics;
  settings.range = {.count = std::max(1, job.native_bins),
                    .step_m = job.native_bins > 0 ? job.native_bin_m : 0.01,
                    .compression_log2 = 0,
                    .compression_peak = false};
  settings.transmit = job.transmit;
  settings.physical.gain_db += job.gain_db;
  return settings;
}

}  // namespace sonard::server
