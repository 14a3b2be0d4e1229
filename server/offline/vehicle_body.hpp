// SPDX-License-Identifier: Apache-2.0
// Moves the bodies of the world while a vehicle follows its trajectory.
#pragma once

#include <cstdint>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// Moves bodies with their own trajectories, and the vehicle's model if the trajectory has one, to their
/// poses at a time.
/// @param truth may be null
void place_bodies(const VehicleTrajectory& trajectory, std::int64_t time_ns, render::SonarRenderer& renderer,
                  BodyTruth* truth);

}  // namespace sonard::server
