// SPDX-License-Identifier: Apache-2.0
// Why a picture is black: what the sonar's place in the world says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/scene/world.hpp"
#include "server/diagnosis/finding.hpp"
#include "server/pose/posed_body.hpp"

namespace sonard::server {

/// From where a sonar looks, and how far.
struct Sight {
  render::Pose T_world_vehicle;
  render::Pose T_world_sonar;
  double azimuth_rad = 0.0;    ///< of the whole fan
  double elevation_rad = 0.0;  ///< likewise
  double range_m = 0.0;
  bool sees_surface = false;    ///< false: its newest ping had no surface in range and fan
  std::string vehicle_model{};  ///< the body that the vehicle is; empty: none
  bool hides_vehicle = false;   ///< whether that is left out of the picture
};

/// What is wrong with it, the likeliest cause first; empty: nothing is. Distances are those to triangles:
/// a world of a million takes some ten milliseconds, but only where the sonar sees nothing.
/// @param moved where bodies are that are not where the world has them
std::vector<Finding> look_around(const render::World& world, const std::vector<PosedBody>& moved,
                                 const Sight& sight);

}  // namespace sonard::server
