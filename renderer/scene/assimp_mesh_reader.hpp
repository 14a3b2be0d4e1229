// SPDX-License-Identifier: Apache-2.0
// Triangles out of whatever Assimp can read. Runs inside run_isolated(): nothing here is safe against bad
// files.
#pragma once

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads the file, and files that it names (buffers of a .gltf, materials of an .obj) if they lie in the
/// folders of `source`. All transforms inside the file are applied. Axes and unit stay those of the file;
/// only an FBX becomes metres with z up. Points, lines, skeletons and poses of animations are left out. With
/// a submesh are taken, as in Gazebo, the meshes of the nodes of that name, without those of named nodes
/// below; if there are none, the meshes of that name or with a node of that id; if there are none, all below
/// such a node.
/// @throws std::runtime_error if Assimp cannot read the file, or if it names an existing one outside of the
/// folders or one that is not regular.
RawMesh read_with_assimp(const MeshSource& source);

}  // namespace sonard::render
