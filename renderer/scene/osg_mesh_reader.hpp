// SPDX-License-Identifier: Apache-2.0
// Triangles out of whatever osgDB can read. Runs inside run_isolated(): nothing here is safe against bad
// files.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads `file` (and no other: textures, material images and references to further files or servers are
/// refused), keeps its axes and its unit, applies all transforms inside it. With a `submesh` only the nodes
/// of that name are taken.
/// @throws std::runtime_error when osgDB has no node for it.
RawMesh read_with_osg(const std::filesystem::path& file, const std::string& submesh);

}  // namespace sonard::render
