#include "server/devices/micron_settings.hpp"

#include <algorithm>

#include <glm/gtc/quaternion.hpp>

namespace sonard::server {

render::SonarSettings to_sonar_settings(const micron::MicronJob& job, const MicronHeadConfig& head) {
  render::SonarSettings settings = head.acoustics;
  settings.range = {.count = std::max(1, job.bins),
                    .step_m = job.bins > 0 ? job.bin_length_m : 0.01,
                    .compression_log2 = 0,
                    .compression_peak = false};
  settings.transmit = job.transmit;
  settings.physical.gain_db += job.gain_db - head.nominal_gain_db;
  if (head.chirp_bandwidth_hz > 0.0 && job.sound_speed_mps > 0.0) {
    settings.physical.range_cell_m = job.sound_speed_mps / (2.0 * head.chirp_bandwidth_hz);
  }
  return settings;
}

render::Pose T_world_transducer(const render::Pose& T_world_mount, const micron::MicronJob& job) {
  // Bearings are positive to starboard, turns about z to port.
  return T_world_mount * render::Pose{{0.0, 0.0, 0.0}, glm::angleAxis(-job.bearing_rad, glm::dvec3(0, 0, 1))};
}

}  // namespace sonard::server
