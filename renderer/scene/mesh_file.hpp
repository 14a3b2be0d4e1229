// SPDX-License-Identifier: Apache-2.0
// Loads mesh files under strict rules: existing local files of known formats; axes kept, unit applied;
// normals only if the file has them; an error if the result is empty. See docs/worlds.md.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/scene/world.hpp"

namespace sonard::render {

struct MeshFileRequest {
  std::filesystem::path file;   ///< absolute
  std::string submesh;          ///< only the parts with this name; empty = all
  bool center_submesh = false;  ///< moves the centre of the bounding box to the origin, before scaling
  glm::dvec3 scale{1.0};        ///< negative values mirror
  bool tangents = false;        ///< for a normal map, if the mesh has texture coordinates
  std::vector<std::filesystem::path> folders{};  ///< for files that it names, besides its own folder

  bool operator==(const MeshFileRequest&) const = default;
};

struct MeshFilePart {
  std::string material_name;  ///< as in the file, may be empty
  std::shared_ptr<const TriangleMesh> mesh;
  glm::dvec3 scale{1.0};  ///< MeshFileRequest::scale
};

struct MeshFile {
  std::vector<MeshFilePart> parts;  ///< one per material, each with at least one triangle
  MeshDiagnostics diagnostics;
  std::vector<std::string> warnings;  ///< each has the file name
  std::string up_axis{};              ///< "X_UP" or "Y_UP" if a COLLADA file has it, not applied; else empty
};

/// @throws MissingFile with the file name if there are no triangles, or no such submesh; WorldError with the
/// file name if the file is not found, not local, damaged, of unknown format, or has more than 50 million
/// triangles.
MeshFile load_mesh_file(const MeshFileRequest& request);

}  // namespace sonard::render
