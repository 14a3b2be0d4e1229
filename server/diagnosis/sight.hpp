// SPDX-License-Identifier: Apache-2.0
// Causes of a black picture that follow from the sonar's place in the world.
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

/// A larger distance between the origins of a vehicle and its sonar is suspicious: vehicles are smaller.
inline constexpr double longest_arm_m = 10.0;

/// Pose and range of a sonar, and results of its newest ping.
struct Sight {
  render::Pose T_world_vehicle;
  render::Pose T_world_sonar;
  double range_m = 0.0;
  /// false: no surface was in range and fan of the newest ping; nullopt: there was no ping
  std::optional<bool> sees_surface = false;
  /// PingStatistics::echo_over_floor of the newest ping
  double echo_over_floor = std::numeric_limits<double>::infinity();
  std::string vehicle_model{};  ///< the vehicle's own body; empty: it has no body
  bool hides_vehicle = false;   ///< true if the image omits it
};

/// A bounding box of a body, in its own frame; without a mesh, min_m > max_m.
struct BodyBox {
  glm::dvec3 min_m, max_m;
};
/// Bounding boxes, in the order of the bodies. Reads every corner of every mesh.
std::vector<BodyBox> boxes_of(const render::World& world);

/// Echo intensity, relative to noise and the least step of samples, below which an echo does not stand out in
/// a picture. An echo as strong as the noise raises a sample by 3 dB, which is less than the spread of
/// speckle and noise (5.6 dB).
inline constexpr double least_visible_echo = 1.0;

/// Findings about the sonar's place, the likeliest cause first; empty if nothing looks wrong. Distances are
/// to triangles: a world of a million takes some ten milliseconds, but only if the sonar sees nothing.
/// @param boxes boxes_of(world)
/// @param moved current poses of bodies that have moved
std::vector<Finding> look_around(const render::World& world, const std::vector<BodyBox>& boxes,
                                 const std::vector<PosedBody>& moved, const Sight& sight);

}  // namespace sonard::server
