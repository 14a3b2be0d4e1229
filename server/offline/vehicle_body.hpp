// SPDX-License-Identifier: Apache-2.0
// What moves in the world while a vehicle follows its trajectory.
#pragma once

#include <cstdint>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// Moves the bodies that have a way of their own, and the model of the vehicle where the trajectory has one,
/// to where they are at a time.
/// @param truth may be null
void place_bodies(const VehicleTrajectory& trajectory, std::int64_t time_ns, render::SonarRenderer& renderer,
                  BodyTruth* truth);

}  // namespace sonard::server
