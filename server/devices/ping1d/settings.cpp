// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping1d/settings.hpp"

#include <algorithm>
#include <numbers>

namespace sonard::server {

render::SonarSettings ping1d_sonar_settings(const PingJob& job, const HeadConfig& head) {
  render::SonarSettings settings = head.acoustics;
  settings.range = {.count = std::max(1, job.native_bins),
                    .step_m = job.native_bins > 0 ? job.native_bin_m : 0.01,
                    .compression_log2 = 0,
                    .compression_peak = false};
  settings.transmit = job.transmit;
  settings.sixteen_bit = job.sixteen_bit;
  settings.physical.gain_db += job.gain_db;
  return settings;
}

// Beams of 30 and 25 degrees and least ranges from the maker's pages (docs/protocols/ping1d.md 3.4). The cone
// is drawn as a beam with a sharp width across and the pattern of the transducer along. Echoes have no
// length, so that the strongest point of a profile is where the bed is. The head has no time-varying gain.
render::SonarSettings ping1d_acoustics(Ping1dModel model) {
  constexpr double degree = std::numbers::pi / 180.0;
  const double width_rad = (model == Ping1dModel::ping1d ? 30.0 : 25.0) * degree;
  render::SonarSettings acoustics;
  acoustics.aperture.beam_edges_rad = {width_rad / 2.0, -width_rad / 2.0};
  acoustics.aperture.receive_beamwidth_rad = width_rad;
  acoustics.aperture.vertical_beamwidth_rad = width_rad;
  acoustics.aperture.elevation = render::Aperture::Elevation::sinc_two_way;  // same transducer both ways
  acoustics.physical.pulse.shape = render::PulseSettings::Shape::point;
  acoustics.physical.gain_db = 40.0;
  acoustics.physical.tvg.log_coefficient = 0.0;
  acoustics.physical.tvg.max_db = 0.0;
  acoustics.physical.noise.level_db = -110.0;
  acoustics.physical.near_field_blank_m = 0.0;
  acoustics.physical.ring_down.on = true;
  acoustics.physical.ring_down.from_start = true;
  acoustics.physical.ring_down.peak_m = 0.1;
  acoustics.physical.ring_down.end_m = model == Ping1dModel::ping1d ? 0.5 : 0.3;
  acoustics.physical.noise.broadside_stripe_db = 0.0;
  return acoustics;
}

}  // namespace sonard::server
