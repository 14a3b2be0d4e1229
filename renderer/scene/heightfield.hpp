// SPDX-License-Identifier: Apache-2.0
// Terrain from a grey image.
#pragma once

#include <glm/vec3.hpp>

#include "renderer/scene/image_file.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// One vertex per pixel, two triangles per four pixels, smooth normals. The picture seen from above has its
/// top towards +y and its right towards +x; corner pixels lie on the corners of size.x by size.y, which is
/// centred at centre.x, centre.y. Black is at height centre.z, the brightest pixel of the picture size.z
/// above it, as Gazebo does it. No triangle touches a hole. Texture coordinates run over [0, 1] from the
/// lower left corner.
/// @throws WorldError for an image below 2 x 2 pixels or sizes that are not finite, x and y > 0, z >= 0.
TriangleMesh make_heightfield(const GreyImage& image, const glm::dvec3& size_m, const glm::dvec3& centre_m);

/// @throws WorldError as make_heightfield()
void check_heightfield(const GreyImage& image, const glm::dvec3& size_m, const glm::dvec3& centre_m);

}  // namespace sonard::render
