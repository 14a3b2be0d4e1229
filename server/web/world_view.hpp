// SPDX-License-Identifier: Apache-2.0
// The world seen from above and from the side, for people who look for their vehicle in it.
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

/// Where all of a world lies, in its own frame.
struct Extent {
  glm::dvec3 min_m{0.0}, max_m{0.0};
};
Extent extent_of(const render::World& world);

/// The answer to GET /api/world: name, extent, and for each body its outlines, its pose at the start, and how
/// many triangles it has.
nlohmann::json world_json(const render::World& world);

/// A grey picture of the bodies where they stand at the start, as PNG with alpha, which covers exactly the
/// extent of the world: what is nearest to who looks is seen, lit from the upper left.
std::string world_png(const render::World& world, ViewFrom from);

}  // namespace sonard::server
