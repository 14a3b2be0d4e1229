// SPDX-License-Identifier: Apache-2.0
// The reader of each mesh format. The choice is measured: docs/worlds.md.
#pragma once

#include <span>
#include <string_view>

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Extensions of the supported formats, in lower case without the dot.
std::span<const std::string_view> mesh_extensions();

/// Returns the triangles of a file of these formats, in its unit and axes (an FBX: in metres, z up). Its
/// reader runs in a separate process.
/// @throws std::runtime_error with the message of the reader, if it fails, crashes, or takes too long
RawMesh read_mesh(const MeshSource& source);

}  // namespace sonard::render
