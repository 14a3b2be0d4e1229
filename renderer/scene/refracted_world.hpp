// SPDX-License-Identifier: Apache-2.0
// Worlds made ready for refraction: facets small enough to bend, and bodies bent on the CPU.
#pragma once

#include <vector>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// The world with facets so short that, moved at their corners, none is further than 0.25 mm from where it
/// should be: a parabola of curvature k departs from a chord of length L by k L^2 / 8. Where that would take
/// more than some two million facets they are longer. Meshes that parts share stay shared.
/// @param ray_curvature_per_m RendererOptions::ray_curvature_per_m, not 0
World refractable(const World& world, double ray_curvature_per_m);

/// The longest edge in it.
float refractable_edge_m(const World& world, double ray_curvature_per_m);

/// The bodies as they are seen from `sonar_position_m`, see Refraction, at poses without a turn in axes of
/// the world around the sonar. For methods that cannot move corners themselves.
World refracted_world(const World& world, const glm::dvec3& sonar_position_m, double bend_per_m);

}  // namespace sonard::render
