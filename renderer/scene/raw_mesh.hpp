// SPDX-License-Identifier: Apache-2.0
// Unchecked triangles from a third-party reader, and their bytes for the transfer out of its process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sonard::render {

/// Input of a mesh reader.
struct MeshSource {
  std::filesystem::path file;
  std::string submesh{};  ///< only the parts with this name; empty: all
  /// Files named by `file` must lie below one of these folders, or below its own folder.
  std::vector<std::filesystem::path> folders{};
};

/// The triangles of one material; attribute arrays are empty or as long as `positions`.
struct RawPart {
  std::string material_name;  ///< as in the file, may be empty
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> texcoords;
  std::vector<std::uint32_t> indices;
};

struct RawMesh {
  std::vector<RawPart> parts;
  std::vector<std::string> names;     ///< of nodes, meshes or solids, for error messages; may repeat
  std::vector<std::string> warnings;  ///< without the name of the file

  /// Adds triangles, moved by `T_mesh_part`, to the part of the same material and attributes. Under a
  /// mirroring transform, the outside of the triangles stays outside.
  void add(const RawPart& triangles, const glm::dmat4& T_mesh_part);
};

std::string to_bytes(const RawMesh& mesh);
/// Makes names and warnings printable().
/// @throws std::runtime_error if the bytes are damaged.
RawMesh raw_mesh_of(const std::string& bytes);

}  // namespace sonard::render
