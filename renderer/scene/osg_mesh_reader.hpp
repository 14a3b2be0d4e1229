// SPDX-License-Identifier: Apache-2.0
// Triangles of OpenSceneGraph's own formats. Runs inside run_isolated(), because damaged files can crash
// osgDB.
#pragma once

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads only the file itself: textures, material images and references to further files or servers are
/// refused. Axes and unit stay as in the file; all transforms inside it are applied. With a submesh, only the
/// nodes of that name are read.
/// @throws std::runtime_error if osgDB returns no node.
RawMesh read_with_osg(const MeshSource& source);

}  // namespace sonard::render
