// SPDX-License-Identifier: Apache-2.0
// Triangles of all files that osgDB can read. Runs inside run_isolated(), because damaged files can crash it.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads only `file`: textures, material images and references to further files or servers are refused. Axes
/// and unit stay as in the file; all transforms inside it are applied. With a `submesh`, only the nodes of
/// that name are read.
/// @throws std::runtime_error if osgDB returns no node.
RawMesh read_with_osg(const std::filesystem::path& file, const std::string& submesh);

}  // namespace sonard::render
