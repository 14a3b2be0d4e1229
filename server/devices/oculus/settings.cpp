// SPDX-License-Identifier: Apache-2.0
#include "server/devices/oculus/settings.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "server/devices/device_type.hpp"

namespace sonard::server {
namespace {

/// Beams point to the bearings of the head's table (protocol/oculus/README.md 4.5), from one end of the
/// aperture to the other. Each reaches half way to its neighbours, in sine.
std::vector<double> beam_edges_rad(int beams, double aperture_deg) {
  const double end = std::sin(aperture_deg * std::numbers::pi / 360.0);
  const double outermost = end * beams / (beams - 1);
  std::vector<double> edges;
  for (int edge = 0; edge <= beams; ++edge) {
    edges.push_back(azimuth_rad(std::asin(outermost * (2.0 * edge / beams - 1.0))));
  }
  return edges;
}

}  // namespace

render::SonarSettings oculus_sonar_settings(const PingJob& job, const HeadConfig& head) {
  const OculusConfig& config = device_settings<OculusConfig>(head);
  const auto index = static_cast<std::size_t>(job.mode);
  const OculusModeAcoustics& low = config.modes[0];
  const OculusModeAcoustics& mode = config.modes.at(index);
  render::SonarSettings settings = head.acoustics;
  render::Aperture& aperture = settings.aperture;
  aperture.beam_edges_rad =
      beam_edges_rad(job.beams, config.device.plan.model.modes.at(index).horizontal_deg);
  aperture.vertical_beamwidth_rad = mode.vertical_beamwidth_rad;
  aperture.receive_beamwidth_rad = mode.receive_beamwidth_rad;
  settings.range = {
      .count = job.native_bins, .step_m = job.native_bin_m, .compression_log2 = 0, .compression_peak = false};
  settings.sixteen_bit = job.sixteen_bit;
  settings.output_scale = render::OutputScale::power;
  settings.output_exponent = job.amplitude_exponent;
  render::PhysicalModel& physical = settings.physical;
  physical.pulse.range_cell_m = mode.range_cell_m;
  physical.absorption_db_per_m = mode.absorption_db_per_m;
  // The head's error in the absorption of its water is the same at both frequencies.
  physical.tvg.absorption_db_per_m += mode.absorption_db_per_m - low.absorption_db_per_m;
  physical.multipath.wavelength_m = mode.wavelength_m;
  physical.noise.level_db += mode.noise_db;
  physical.gain_db += (job.gain_percent - 50.0) * config.gain_db_per_percent;
  return settings;
}

}  // namespace sonard::server
