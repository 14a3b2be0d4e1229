// SPDX-License-Identifier: Apache-2.0
// Triangles of all files that Assimp can read. Runs inside run_isolated(), because damaged files can crash
// it.
#pragma once

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads the file, and files that it names (buffers of a .gltf) if they lie in the folders of `source`. All
/// transforms inside the file are applied. Axes and unit stay as in the file; only an FBX becomes metres with
/// z up. Points, lines, skeletons and poses of animations are left out. With a submesh, the result has the
/// meshes of the nodes of that name, as in Gazebo, without named nodes below. If there are no such nodes: the
/// meshes of that name or with a node of that id. If these do not exist either: all meshes below such a node.
/// @throws std::runtime_error if Assimp cannot read the file, or if it names an existing file that is outside
/// of the folders or not regular.
RawMesh read_with_assimp(const MeshSource& source);

}  // namespace sonard::render
