// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/raw_mesh.hpp"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "common/text/printable.hpp"
#include "renderer/scene/blob.hpp"

namespace sonard::render {
namespace {

RawPart& part_like(RawMesh& mesh, const RawPart& triangles) {
  for (RawPart& part : mesh.parts) {
    if (part.material_name == triangles.material_name && part.normals.empty() == triangles.normals.empty() &&
        part.texcoords.empty() == triangles.texcoords.empty()) {
      return part;
    }
  }
  mesh.parts.emplace_back().material_name = triangles.material_name;
  return mesh.parts.back();
}

void put(const std::vector<std::string>& texts, BlobWriter& writer) {
  writer.put(static_cast<std::uint64_t>(texts.size()));
  for (const std::string& text : texts) {
    writer.put(text);
  }
}

std::vector<std::string> get_texts(BlobReader& reader) {
  std::vector<std::string> texts;
  const std::uint64_t count = reader.get_number();
  for (std::uint64_t i = 0; i < count; ++i) {
    texts.push_back(printable(reader.get_string()));
  }
  return texts;
}

}  // namespace

void RawMesh::add(const RawPart& triangles, const glm::dmat4& T_mesh_part) {
  if (triangles.positions.empty() || triangles.indices.empty()) {
    return;
  }
  RawPart& part = part_like(*this, triangles);
  const auto base = static_cast<std::uint32_t>(part.positions.size());
  for (const glm::dvec3& p : triangles.positions) {
    part.positions.emplace_back(T_mesh_part * glm::dvec4(p, 1.0));
  }
  const glm::dmat3 linear(T_mesh_part);
  const glm::dmat3 turn_normals = glm::transpose(glm::inverse(linear));
  for (const glm::vec3& n : triangles.normals) {
    part.normals.emplace_back(turn_normals * glm::dvec3(n));
  }
  part.texcoords.insert(part.texcoords.end(), triangles.texcoords.begin(), triangles.texcoords.end());
  const bool mirrored = glm::determinant(linear) < 0.0;
  const std::vector<std::uint32_t>& indices = triangles.indices;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    part.indices.insert(part.indices.end(), {base + indices[i], base + indices[mirrored ? i + 2 : i + 1],
                                             base + indices[mirrored ? i + 1 : i + 2]});
  }
}

std::string to_bytes(const RawMesh& mesh) {
  BlobWriter writer;
  writer.put(static_cast<std::uint64_t>(mesh.parts.size()));
  for (const RawPart& part : mesh.parts) {
    writer.put(part.material_name);
    writer.put(part.positions);
    writer.put(part.normals);
    writer.put(part.texcoords);
    writer.put(part.indices);
  }
  put(mesh.names, writer);
  put(mesh.warnings, writer);
  return writer.take();
}

RawMesh raw_mesh_of(const std::string& bytes) {
  BlobReader reader(bytes);
  RawMesh mesh;
  const std::uint64_t parts = reader.get_number();
  for (std::uint64_t i = 0; i < parts; ++i) {
    RawPart& part = mesh.parts.emplace_back();
    part.material_name = printable(reader.get_string());
    part.positions = reader.get_vector<glm::dvec3>();
    part.normals = reader.get_vector<glm::vec3>();
    part.texcoords = reader.get_vector<glm::vec2>();
    part.indices = reader.get_vector<std::uint32_t>();
  }
  mesh.names = get_texts(reader);
  mesh.warnings = get_texts(reader);
  return mesh;
}

}  // namespace sonard::render
