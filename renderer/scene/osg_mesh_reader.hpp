// SPDX-License-Identifier: Apache-2.0
// Triangles out of whatever osgDB can read. Runs inside run_isolated(): nothing here is safe against bad
// files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sonard::render {

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
  std::vector<std::string> names;  ///< nodes and drawables, for error messages
};

/// Reads `file` (and no other: textures, material images and references to further files or servers are
/// refused), keeps its axes, applies all transforms inside it. With a `submesh` only the nodes of that name
/// are taken.
/// @throws std::runtime_error when osgDB has no node for it.
RawMesh read_with_osg(const std::filesystem::path& file, const std::string& submesh);

std::string to_bytes(const RawMesh& mesh);
/// @throws std::runtime_error when the bytes are damaged.
RawMesh raw_mesh_of(const std::string& bytes);

}  // namespace sonard::render
