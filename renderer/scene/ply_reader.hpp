// SPDX-License-Identifier: Apache-2.0
// PLY files. OpenSceneGraph crashes on many damaged ones and reads what is there of one that is cut short;
// Assimp takes the first bytes of some binary ones for the end of the header.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads the elements `vertex` (x y z; nx ny nz if all three are there; u v, s t, texture_u texture_v or
/// texture_s texture_t) and `face` (vertex_indices or
/// vertex_index, as a fan of triangles) of a text or a binary file of either byte order. Other elements and
/// properties are skipped. A PLY has no names, so that with a `submesh` the result is empty.
/// @throws std::runtime_error naming the line of a header or a text, or the element whose instances are not
/// all there
RawMesh read_ply(const std::filesystem::path& file, const std::string& submesh);

}  // namespace sonard::render
