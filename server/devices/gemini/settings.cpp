// SPDX-License-Identifier: Apache-2.0
#include "server/devices/gemini/settings.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "protocol/gemini/bearings.hpp"
#include "protocol/gemini/messages.hpp"
#include "server/devices/device_type.hpp"

namespace sonard::server {
namespace {

// Limit of steering: it allows c / c_d up to 1.15, more than occurs in water.
constexpr double widest_sin = 0.9962;  // 85 degrees

// Levels were set between images of 20 and 50 m (docs/physics.md 2.6): clients request this pulse at 30 m.
constexpr double usual_pulse_s = 18 / gemini::carrier_hz;

// `steering`: c / c_d, the true sound speed over the speed that the beamformer assumes. A beam meant for the
// bearing b receives sin b * c / c_d (docs/physics.md 2.12).
std::vector<double> beam_edges_rad(double steering) {
  std::vector<double> edges = gemini::beam_edges_sin();
  const double ratio = std::min(steering, widest_sin / std::abs(edges.front()));
  for (double& edge : edges) {
    edge = azimuth_rad(std::asin(ratio * edge));
  }
  return edges;
}

double steering(const PingJob& job, const HeadConfig& head) {
  return device_settings<GeminiConfig>(head).steering_error && job.assumed_sound_speed_mps > 0.0
             ? job.sound_speed_mps / job.assumed_sound_speed_mps
             : 1.0;
}

}  // namespace

render::SonarSettings gemini_sonar_settings(const PingJob& job, const HeadConfig& head) {
  render::SonarSettings settings = head.acoustics;
  settings.aperture.beam_edges_rad = beam_edges_rad(steering(job, head));
  settings.range = {.count = job.native_bins,
                    .step_m = job.native_bin_m,
                    .compression_log2 = job.compression_log2,
                    .compression_peak = false};  // a 720i always averages (protocol/gemini/README.md 5)
  settings.sixteen_bit = job.sixteen_bit;
  settings.transmit = job.transmit;
  settings.physical.pulse.range_cell_m = job.sound_speed_mps * job.pulse_s / 2.0;
  settings.physical.pulse.usual = {job.sound_speed_mps * usual_pulse_s / 2.0, job.native_bin_m};
  settings.physical.gain_db += job.gain_db;
  return settings;
}

}  // namespace sonard::server
