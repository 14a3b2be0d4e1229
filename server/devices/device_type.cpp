// SPDX-License-Identifier: Apache-2.0
#include "server/devices/device_type.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "renderer/sample_grid/sample_grid.hpp"
#include "server/net/pty_port.hpp"
#include "server/recording/glf_device.hpp"

namespace sonard::server {

SocketTrouble trouble_of(const SocketError& error, const DeviceType& type) {
  if (const auto* const link = dynamic_cast<const PtyLinkError*>(&error)) {
    return {fmt::format("serial.pty[{}].link", link->item), false};
  }
  return {type.socket_key(), true};
}

// If the head looks straight up or down, heading and roll are not distinct: roll is then 0.
SensorReadings sensor_readings(const render::Pose& T_world_mount, std::optional<double> water_surface_z_m,
                               const glm::dvec3& velocity_mps) {
  constexpr double vertical = 1e-6;
  constexpr double turn = 2 * std::numbers::pi;
  const glm::dvec3 ahead = T_world_mount.orientation * glm::dvec3(1, 0, 0);
  const glm::dvec3 port = T_world_mount.orientation * glm::dvec3(0, 1, 0);
  const glm::dvec3 up = T_world_mount.orientation * glm::dvec3(0, 0, 1);
  const double level = std::hypot(ahead.x, ahead.y);
  SensorReadings readings;
  const double heading = level > vertical ? std::atan2(ahead.x, ahead.y) : std::atan2(port.y, -port.x);
  readings.heading_rad = heading < 0.0 ? std::fmod(heading + turn, turn) : heading;
  readings.pitch_rad = std::atan2(ahead.z, level);
  readings.roll_rad = level > vertical ? std::atan2(port.z, up.z) : 0.0;
  if (water_surface_z_m) {
    readings.depth_m = *water_surface_z_m - T_world_mount.position_m.z;
  }
  const glm::dquat& q = T_world_mount.orientation;
  readings.orientation_wxyz = {q.w, q.x, q.y, q.z};
  readings.velocity_mps = {velocity_mps.x, velocity_mps.y, velocity_mps.z};
  return readings;
}

render::Pose T_world_transducer(const render::Pose& T_world_mount, double bearing_rad) {
  const glm::dquat turned = glm::angleAxis(azimuth_rad(bearing_rad), glm::dvec3(0, 0, 1));
  return T_world_mount * render::Pose{{0.0, 0.0, 0.0}, turned};
}

render::SonarSettings usual_settings(const HeadConfig& head) {
  const DeviceType& type = type_of(head);
  return type.sonar_settings(type.usual_job(head), head);
}

render::PingRequest usual_ping(const HeadConfig& head, const render::Pose& T_world_vehicle) {
  return {T_world_vehicle * head.T_vehicle_sonar, usual_settings(head), 0, head.seed};
}

void check_sampling_of(const HeadConfig& head) {
  const render::SonarSettings settings = usual_settings(head);
  if (render::needs_grid(settings)) {
    render::make_sample_grid(settings.aperture, settings.sampling, render::grid_options(settings));
  }
}

std::vector<HeadToRecord> recorded_heads(const std::vector<HeadConfig>& heads) {
  std::vector<HeadToRecord> recorded;
  for (const HeadConfig& head : heads) {
    const HeadType& type = *head.type;
    recorded.push_back({head.name, std::string(type.name()), type.device_id(head), glf_device(type),
                        dynamic_cast<const PacketLogDevice*>(&type) != nullptr});
  }
  return recorded;
}

}  // namespace sonard::server
