// SPDX-License-Identifier: Apache-2.0
// Divides meshes into smaller triangles.
#pragma once

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Divides a surface until no edge is longer than `longest_edge_m` (> 0, metres). Whether an edge is halved
/// depends only on its length, so triangles with a common edge stay joined without gaps. Normals, tangents
/// and texture coordinates are interpolated.
TriangleMesh tessellated(const TriangleMesh& mesh, float longest_edge_m);

}  // namespace sonard::render
