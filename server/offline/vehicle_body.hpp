// SPDX-License-Identifier: Apache-2.0
// The vehicle's own model along a trajectory.
#pragma once

#include <cstdint>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// Moves the model of the vehicle, where the trajectory has one, to where the vehicle is at a time.
/// @param truth may be null
void place_vehicle(const VehicleTrajectory& trajectory, std::int64_t time_ns, render::SonarRenderer& renderer,
                   BodyTruth* truth);

}  // namespace sonard::server
