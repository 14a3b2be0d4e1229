// SPDX-License-Identifier: Apache-2.0
#include "server/offline/vehicle_body.hpp"

namespace sonard::server {

void place_bodies(const VehicleTrajectory& trajectory, std::int64_t time_ns, render::SonarRenderer& renderer,
                  BodyTruth* truth) {
  const auto place = [&](const std::string& body, const render::Pose& T_world_body) {
    renderer.set_body_pose(body, T_world_body);
    if (truth != nullptr) {
      truth->set_body_pose(body, T_world_body);
    }
  };
  for (const VehicleTrajectory::BodyWay& way : trajectory.bodies()) {
    place(way.body, way.T_world_body(time_ns));
  }
  if (!trajectory.vehicle_model().empty()) {
    place(trajectory.vehicle_model(), trajectory.T_world_vehicle(time_ns));
  }
}

}  // namespace sonard::server
