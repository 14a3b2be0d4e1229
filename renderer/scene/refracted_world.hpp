// SPDX-License-Identifier: Apache-2.0
// Prepares worlds for refraction: facets small enough to bend, and bodies bent on the CPU.
#pragma once

#include <vector>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// The world with short facets: if refraction moves their corners, no facet is off by more than 0.25 mm. A
/// parabola of curvature k departs from a chord of length L by k L^2 / 8. If that takes more than about two
/// million facets, they are longer. Meshes that parts share stay shared.
/// @param ray_curvature_per_m RendererOptions::ray_curvature_per_m, not 0
World refractable(const World& world, double ray_curvature_per_m);

/// Length limit of the edges in refractable(), metres.
float refractable_edge_m(const World& world, double ray_curvature_per_m);

/// The bodies as seen from `sonar_position_m`, see Refraction. Their poses are identity; coordinates are
/// relative to the sonar, in the axes of the world. For methods that cannot move corners themselves.
World refracted_world(const World& world, const glm::dvec3& sonar_position_m, double bend_per_m);

}  // namespace sonard::render
