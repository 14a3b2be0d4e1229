// SPDX-License-Identifier: Apache-2.0
// PLY files. Assimp misreads the first bytes of some binary files as the end of the header.
#pragma once

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads the elements `vertex` (x y z; nx ny nz if all three exist; u v, s t, texture_u texture_v or
/// texture_s texture_t) and `face` (vertex_indices or vertex_index, as a fan of triangles). The file is text,
/// or binary of either byte order. Other elements and properties are skipped. A PLY has no names, so with a
/// submesh the result is empty.
/// @throws std::runtime_error with the line of a header or a text, or with the element that lacks instances
RawMesh read_ply(const MeshSource& source);

}  // namespace sonard::render
