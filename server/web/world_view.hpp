// SPDX-License-Identifier: Apache-2.0
// Views of the world from above and from the side, to find the vehicle in it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "renderer/scene/world.hpp"

namespace sonard::server {

enum class ViewFrom {
  above,  ///< x to the right, y up
  south,  ///< x to the right, z up
};

/// Bounding box of a world, in its own frame.
struct Extent {
  glm::dvec3 min_m{0.0}, max_m{0.0};
};
Extent extent_of(const render::World& world);

/// The response to GET /api/world: name, extent, and each body's outlines, initial pose and number of
/// triangles.
nlohmann::json world_json(const render::World& world);

/// A grey picture of the bodies at their initial poses, as PNG with alpha, that covers exactly the extent of
/// the world. It shows the surface nearest to the viewer, lit from the upper left.
std::string world_png(const render::World& world, ViewFrom from);

}  // namespace sonard::server
