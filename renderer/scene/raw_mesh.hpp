// SPDX-License-Identifier: Apache-2.0
// Triangles as a foreign reader found them, unchecked, and as bytes on their way out of its process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sonard::render {

/// What a reader is to read.
struct MeshSource {
  std::filesystem::path file;
  std::string submesh{};  ///< only the parts of this name; empty: all
  /// The files that `file` names must lie below one of these, or in its own folder or below.
  std::vector<std::filesystem::path> folders{};
};

/// The triangles of one material; attribute arrays are empty or as long as `positions`.
struct RawPart {
  std::string material_name;  ///< as the file has it, may be empty
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> texcoords;
  std::vector<std::uint32_t> indices;
};

struct RawMesh {
  std::vector<RawPart> parts;
  std::vector<std::string> names;  ///< of nodes, meshes or solids, for error messages; may repeat

  /// Adds triangles to those of the same material and attributes, moved by `T_mesh_part`. A mirroring
  /// transform keeps the outside of the triangles outside.
  void add(const RawPart& triangles, const glm::dmat4& T_mesh_part);
};

std::string to_bytes(const RawMesh& mesh);
/// Names are made printable().
/// @throws std::runtime_error when the bytes are damaged.
RawMesh raw_mesh_of(const std::string& bytes);

}  // namespace sonard::render
