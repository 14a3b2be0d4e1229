// SPDX-License-Identifier: Apache-2.0
// Meshes in smaller triangles.
#pragma once

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Divides a surface until no edge is longer than `longest_edge_m` (> 0, metres). Edges are halved until they
/// are short enough, whatever lies beside them, so triangles that met along an edge still do, without gaps.
/// Normals, tangents and texture coordinates are interpolated.
TriangleMesh tessellated(const TriangleMesh& mesh, float longest_edge_m);

}  // namespace sonard::render
