// SPDX-License-Identifier: Apache-2.0
// Triangles of the formats that OpenSceneGraph does not read: glTF 2.0 and FBX, through Assimp. Runs inside
// run_isolated(): nothing here is safe against bad files.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

/// Reads `file`, of a .gltf its buffers too where they lie in its folder or below, and nothing else. All
/// transforms inside the file are applied. Axes of a glTF are those of the file, as in Gazebo; an FBX names
/// its own unit and axes, which become metres and z up. With a `submesh` only the nodes or meshes of that
/// name are taken. Points, lines, skeletons and poses of animations are left out.
/// @throws std::runtime_error when Assimp cannot read it, or this program was built without Assimp.
RawMesh read_with_assimp(const std::filesystem::path& file, const std::string& submesh);

}  // namespace sonard::render
