// SPDX-License-Identifier: Apache-2.0
#include "server/offline/vehicle_body.hpp"

namespace sonard::server {

void place_vehicle(const VehicleTrajectory& trajectory, std::int64_t time_ns, render::SonarRenderer& renderer,
                   BodyTruth* truth) {
  const std::string& model = trajectory.vehicle_model();
  if (model.empty()) {
    return;
  }
  const render::Pose T_world_vehicle = trajectory.T_world_vehicle(time_ns);
  renderer.set_body_pose(model, T_world_vehicle);
  if (truth != nullptr) {
    truth->set_body_pose(model, T_world_vehicle);
  }
}

}  // namespace sonard::server
