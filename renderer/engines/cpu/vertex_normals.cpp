// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/vertex_normals.hpp"

#include <array>
#include <cstdint>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

/// `v` in the axes of the slice.
inline glm::vec3 in_slice(const Slice& slice, const glm::vec3& v) {
  return {slice.cosine * v.x + slice.sine * v.y, -slice.sine * v.x + slice.cosine * v.y, v.z};
}

}  // namespace

void VertexNormals::Corners::set(std::size_t lane, const PartSurface& part, const FanTriangle& triangle) {
  const std::uint32_t* vertex = &part.mesh->indices[std::size_t{triangle.mesh_triangle} * 3];
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 at = part.mesh->normals[vertex[k]] * part.R_part_sonar;
    position[k][0][lane] = triangle.x[k];
    position[k][1][lane] = triangle.y[k];
    position[k][2][lane] = triangle.z[k];
    normal[k][0][lane] = at.x;
    normal[k][1][lane] = at.y;
    normal[k][2][lane] = at.z;
  }
}

void VertexNormals::find(const FanTriangles& triangles, const std::vector<PartSurface>& parts,
                         WorkerPool& workers) {
  fields_.resize(triangles.count());
  workers.run(FanTriangles::share_count, [&](int share) { find_some(triangles.of_share(share), parts); });
}

void VertexNormals::find_some(std::span<const FanTriangle> triangles, const std::vector<PartSurface>& parts) {
  std::array<const FanTriangle*, lanes> some{};
  std::size_t count = 0;
  Corners corners{};
  Fields fields{};
  const auto finish = [&] {
    interpolate_lanes(corners, fields);
    for (std::size_t i = 0; i < count; ++i) {
      glm::mat3& field = fields_[some[i]->number];
      for (int k = 0; k < 3; ++k) {
        field[k] = {fields.column[k][0][i], fields.column[k][1][i], fields.column[k][2][i]};
      }
    }
    count = 0;
  };
  for (const FanTriangle& triangle : triangles) {
    const PartSurface& part = parts[triangle.part];
    if (part.vertex_normals && !part.mesh->normals.empty()) {
      corners.set(count, part, triangle);
      some[count++] = &triangle;
      if (count == lanes) {
        finish();
      }
    }
  }
  finish();
}

SONARD_SIMD_CLONES
void VertexNormals::interpolate_lanes(const Corners& __restrict from, Fields& __restrict to) {
  for (std::size_t i = 0; i < lanes; ++i) {
    const auto position = [&](std::size_t k) {
      return glm::vec3(from.position[k][0][i], from.position[k][1][i], from.position[k][2][i]);
    };
    const auto normal = [&](std::size_t k) {
      return glm::vec3(from.normal[k][0][i], from.normal[k][1][i], from.normal[k][2][i]);
    };
    const glm::vec3 corner = position(0), edge_b = position(1) - corner, edge_c = position(2) - corner;
    const glm::vec3 across = glm::cross(edge_b, edge_c);
    const glm::vec3 a = normal(0), by_b = normal(1) - a, by_c = normal(2) - a;
    const float nn = glm::dot(across, across);
    const glm::vec3 grows_to_b = glm::cross(edge_c, across) / nn;
    const glm::vec3 grows_to_c = glm::cross(across, edge_b) / nn;
    // The normal extrapolated to the sonar.
    const glm::vec3 at_sonar = a - by_b * glm::dot(grows_to_b, corner) - by_c * glm::dot(grows_to_c, corner);
    const glm::vec3 depth = across / glm::dot(across, corner);
    for (int axis = 0; axis < 3; ++axis) {
      to.column[0][axis][i] =
          at_sonar[axis] * depth.x + by_b[axis] * grows_to_b.x + by_c[axis] * grows_to_c.x;
      to.column[1][axis][i] =
          at_sonar[axis] * depth.y + by_b[axis] * grows_to_b.y + by_c[axis] * grows_to_c.y;
      to.column[2][axis][i] =
          at_sonar[axis] * depth.z + by_b[axis] * grows_to_b.z + by_c[axis] * grows_to_c.z;
    }
  }
}

NormalRun VertexNormals::run(const FanTriangle& triangle, const Slice& slice) const {
  const glm::mat3& field = fields_[triangle.number];
  return {in_slice(slice, field[0] * slice.cosine + field[1] * slice.sine),
          in_slice(slice, field[1] * slice.cosine - field[0] * slice.sine), in_slice(slice, field[2])};
}

void refract(const PartSurface& part, const VisibleSegment& segment, const Slice& slice, float t,
             NormalRun& run) {
  const Refraction& bend = part.refraction_in_part;
  const FanTriangle& triangle = *segment.triangle;
  const glm::vec3 up_in_slice = in_slice(slice, bend.up * part.R_part_sonar);
  const glm::vec3 across = triangle.across();
  const glm::vec3 depth = in_slice(slice, across) / glm::dot(across, triangle.corner(0));
  const float nearness = depth.x + t * depth.z;
  const glm::vec3 middle = (run.at + t * run.per_t) / nearness;
  const float turn = 2 * bend.per_m * glm::dot(middle, up_in_slice);
  run.at -= turn * (glm::vec3(1, 0, 0) - up_in_slice * up_in_slice.x);
  run.per_x -= turn * (glm::vec3(0, 1, 0) - up_in_slice * up_in_slice.y);
  run.per_t -= turn * (glm::vec3(0, 0, 1) - up_in_slice * up_in_slice.z);
}

}  // namespace sonard::render
