// SPDX-License-Identifier: Apache-2.0
// Shapes with a given number of flat facets, in metres. Vertices lie on the true surface; there are no
// normals.
#pragma once

#include <glm/vec3.hpp>

#include "renderer/scene/world.hpp"

namespace sonard::test {

/// A block of `size_m` along its own axes, turned by `yaw_rad` about the vertical through its centre. 12
/// triangles.
render::TriangleMesh make_block(const glm::dvec3& centre_m, const glm::dvec3& size_m, double yaw_rad);

/// A ball of 2 * around * (bands - 1) triangles. around >= 3, bands >= 2.
render::TriangleMesh make_ball(const glm::dvec3& centre_m, double radius_m, int around, int bands);

/// A capped cylinder between two points; 2 * around * (along + 1) triangles. around >= 3, along >= 1.
render::TriangleMesh make_tube(const glm::dvec3& from_m, const glm::dvec3& to_m, double radius_m, int around,
                               int along);

/// Adds the triangles of `part` to `mesh`.
void append(render::TriangleMesh& mesh, const render::TriangleMesh& part);

}  // namespace sonard::test
