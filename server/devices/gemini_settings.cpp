#include "server/devices/gemini_settings.hpp"

#include <cmath>
#include <vector>

#include "protocol/gemini/bearings.hpp"

namespace sonard::server {
namespace {

// Device bearings are positive to starboard, azimuths of the renderer to port.
std::vector<double> beam_edges_rad() {
  std::vector<double> edges = gemini::beam_edges_sin();
  for (double& edge : edges) {
    edge = -std::asin(edge);
  }
  return edges;
}

}  // namespace

render::SonarSettings to_sonar_settings(const gemini::PingJob& job, const render::SonarSettings& acoustics) {
  render::SonarSettings settings = acoustics;
  settings.aperture.beam_edges_rad = beam_edges_rad();
  settings.range = {.count = job.native_lines,
                    .step_m = job.line_step_m,
                    .compression_log2 = job.compression_log2,
                    .compression_peak = false};  // a 720i averages, whatever it is asked (5)
  settings.sixteen_bit = job.sixteen_bit;
  settings.transmit = job.transmit;
  settings.physical.range_cell_m = job.sound_speed_mps * job.pulse_s / 2.0;
  settings.physical.gain_db += job.gain_db;
  return settings;
}

}  // namespace sonard::server
