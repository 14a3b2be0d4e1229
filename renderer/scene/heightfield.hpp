// SPDX-License-Identifier: Apache-2.0
// Terrain from a grey image.
#pragma once

#include <glm/vec3.hpp>

#include "renderer/scene/image_file.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// One vertex per pixel, two triangles per four pixels, smooth normals. Seen from above, the top of the
/// picture is towards +y and its right towards +x. Corner pixels lie on the corners of size.x by size.y,
/// which is centred at centre.x, centre.y. Black is at height centre.z, the brightest pixel size.z above it,
/// as in Gazebo. No triangle touches a hole. Texture coordinates run over [0, 1] from the lower left corner.
/// @throws WorldError if the image is below 2 x 2 pixels, or if a size is not finite or x or y is not above
/// 0.
TriangleMesh make_heightfield(const GreyImage& image, const glm::dvec3& size_m, const glm::dvec3& centre_m);

/// @throws WorldError as make_heightfield()
void check_heightfield(const GreyImage& image, const glm::dvec3& size_m, const glm::dvec3& centre_m);

}  // namespace sonard::render
