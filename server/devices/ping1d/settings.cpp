// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping1d/settings.hpp"

#include "protocol/ping1d/echo.hpp"
#include "server/devices/single_beam.hpp"

namespace sonard::server {

render::SonarSettings ping1d_sonar_settings(const PingJob& job, const HeadConfig& head) {
  render::SonarSettings settings = single_beam_settings(job, head);
  settings.sixteen_bit = job.sixteen_bit;
  if (job.sixteen_bit) {
    settings.output_scale = render::OutputScale::power;
    settings.output_exponent = ping1d::image_exponent;
    settings.output_full_scale = ping1d::image_full_scale;
  }
  return settings;
}

// Beams of 30 and 25 degrees and least ranges from the maker's pages (protocol/ping1d/README.md 3.4). The
// cone is drawn as a beam with a sharp width across and the pattern of the transducer along. Echoes have no
// length, so that the strongest point of a profile is where the bed is. The head has no time-varying gain.
render::SonarSettings ping1d_acoustics(Ping1dModel model) {
  const double width_deg = model == Ping1dModel::ping1d ? 30.0 : 25.0;
  render::SonarSettings acoustics = single_beam_acoustics(width_deg, width_deg);
  acoustics.physical.pulse.shape = render::PulseSettings::Shape::point;
  acoustics.physical.gain_db = 40.0;
  acoustics.physical.tvg.log_coefficient = 0.0;
  acoustics.physical.tvg.max_db = 0.0;
  acoustics.physical.noise.level_db = -110.0;
  acoustics.physical.near_field_blank_m = 0.0;
  acoustics.physical.ring_down.from_start = true;
  acoustics.physical.ring_down.peak_m = 0.1;
  acoustics.physical.ring_down.end_m = model == Ping1dModel::ping1d ? 0.5 : 0.3;
  return acoustics;
}

}  // namespace sonard::server
