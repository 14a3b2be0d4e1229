// SPDX-License-Identifier: Apache-2.0
// Mesh files, under one strict policy: an existing local file of a known format, its axes kept, its unit
// applied, normals only where the file has them, and never silently nothing. See docs/worlds.md.
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
  std::string submesh;          ///< only the parts of this name; empty = all
  bool center_submesh = false;  ///< moves the centre of the bounding box to the origin, before scaling
  glm::dvec3 scale{1.0};        ///< negative values mirror
  bool tangents = false;        ///< for a normal map, where the mesh has texture coordinates
  std::vector<std::filesystem::path> folders{};  ///< where files that it names may lie, beside its own folder

  bool operator==(const MeshFileRequest&) const = default;
};

struct MeshFilePart {
  std::string material_name;  ///< as the file names it, may be empty
  std::shared_ptr<const TriangleMesh> mesh;
  glm::dvec3 scale{1.0};  ///< MeshFileRequest::scale
};

struct MeshFile {
  std::vector<MeshFilePart> parts;  ///< one per material, each with at least one triangle
  MeshDiagnostics diagnostics;
  std::vector<std::string> warnings;  ///< each names the file
  std::string up_axis{};  ///< "X_UP" or "Y_UP" of a COLLADA file, which is not applied; else empty
};

/// @throws MissingFile naming the file: no triangles, no such submesh. WorldError, likewise: not found, not
/// local, unknown format, damaged, more than 50 million triangles.
MeshFile load_mesh_file(const MeshFileRequest& request);

}  // namespace sonard::render
