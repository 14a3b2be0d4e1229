// SPDX-License-Identifier: Apache-2.0
// Why a picture is black: what the sonar's place in the world says.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/scene/world.hpp"
#include "server/diagnosis/finding.hpp"
#include "server/pose/posed_body.hpp"

namespace sonard::server {

/// From where a sonar looks, and how far.
struct Sight {
  render::Pose T_world_vehicle;
  render::Pose T_world_sonar;
  double range_m = 0.0;
  /// false: its newest ping had no surface in range and fan; nullopt: there was no ping
  std::optional<bool> sees_surface = false;
  /// PingStatistics::echo_over_floor of that ping
  double echo_over_floor = std::numeric_limits<double>::infinity();
  std::string vehicle_model{};  ///< the body that the vehicle is; empty: none
  bool hides_vehicle = false;   ///< whether that is left out of the picture
};

/// A box around a body, in its own frame; of a body without a mesh it is inside out.
struct BodyBox {
  glm::dvec3 min_m, max_m;
};
/// In the order of the bodies. Looks at every corner of every mesh.
std::vector<BodyBox> boxes_of(const render::World& world);

/// Echoes of less intensity than this, re noise and the least step of samples, do not stand out of a picture.
inline constexpr double least_visible_echo = 0.25;

/// What is wrong with it, the likeliest cause first; empty: nothing is. Distances are those to triangles:
/// a world of a million takes some ten milliseconds, but only where the sonar sees nothing.
/// @param boxes boxes_of(world)
/// @param moved where bodies are that are not where the world has them
std::vector<Finding> look_around(const render::World& world, const std::vector<BodyBox>& boxes,
                                 const std::vector<PosedBody>& moved, const Sight& sight);

}  // namespace sonard::server
