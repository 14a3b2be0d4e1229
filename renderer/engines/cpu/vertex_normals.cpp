// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/vertex_normals.hpp"

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

/// `v` in the axes of the slice.
inline glm::vec3 in_slice(const Slice& slice, const glm::vec3& v) {
  return {slice.cosine * v.x + slice.sine * v.y, -slice.sine * v.x + slice.cosine * v.y, v.z};
}

}  // namespace

void VertexNormals::add(const PartSurface& part, const FanTriangle& triangle) {
  const std::size_t block = count_ / lanes, lane = count_ % lanes;
  // runs_ grows last: if memory runs out before, the next call tries both again.
  if (block >= runs_.size()) {
    corners_.resize(block + 1);
    runs_.resize(block + 1);
  }
  Corners& to = corners_[block];
  const std::uint32_t* vertex = &part.mesh->indices[std::size_t{triangle.mesh_triangle} * 3];
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 normal = part.mesh->normals[vertex[k]] * part.R_part_sonar;
    to.position[k][0][lane] = triangle.x[k];
    to.position[k][1][lane] = triangle.y[k];
    to.position[k][2][lane] = triangle.z[k];
    to.normal[k][0][lane] = normal.x;
    to.normal[k][1][lane] = normal.y;
    to.normal[k][2][lane] = normal.z;
  }
  ++count_;
}

void VertexNormals::interpolate(const Slice& slice) {
  for (std::size_t block = 0; block * lanes < count_; ++block) {
    interpolate_lanes(slice, corners_[block], runs_[block]);
  }
}

SONARD_SIMD_CLONES
void VertexNormals::interpolate_lanes(const Slice& slice, const Corners& __restrict from,
                                      Runs& __restrict to) {
  for (std::size_t i = 0; i < lanes; ++i) {
    const auto position = [&](std::size_t k) {
      return glm::vec3(from.position[k][0][i], from.position[k][1][i], from.position[k][2][i]);
    };
    const auto normal = [&](std::size_t k) {
      return in_slice(slice, {from.normal[k][0][i], from.normal[k][1][i], from.normal[k][2][i]});
    };
    const glm::vec3 corner = position(0), edge_b = position(1) - corner, edge_c = position(2) - corner;
    const glm::vec3 across = glm::cross(edge_b, edge_c);
    const glm::vec3 a = normal(0), by_b = normal(1) - a, by_c = normal(2) - a;
    const float nn = glm::dot(across, across);
    const glm::vec3 grows_to_b = glm::cross(edge_c, across) / nn;
    const glm::vec3 grows_to_c = glm::cross(across, edge_b) / nn;
    const glm::vec3 b_of = in_slice(slice, grows_to_b), c_of = in_slice(slice, grows_to_c);
    // The normal extrapolated to the sonar.
    const glm::vec3 at_sonar = a - by_b * glm::dot(grows_to_b, corner) - by_c * glm::dot(grows_to_c, corner);
    const glm::vec3 depth = in_slice(slice, across) / glm::dot(across, corner);
    for (int axis = 0; axis < 3; ++axis) {
      to.at[axis][i] = at_sonar[axis] * depth.x + by_b[axis] * b_of.x + by_c[axis] * c_of.x;
      to.per_x[axis][i] = at_sonar[axis] * depth.y + by_b[axis] * b_of.y + by_c[axis] * c_of.y;
      to.per_t[axis][i] = at_sonar[axis] * depth.z + by_b[axis] * b_of.z + by_c[axis] * c_of.z;
    }
  }
}

NormalRun VertexNormals::run(std::size_t i) const {
  const Runs& of = runs_[i / lanes];
  const std::size_t k = i % lanes;
  return {{of.at[0][k], of.at[1][k], of.at[2][k]},
          {of.per_x[0][k], of.per_x[1][k], of.per_x[2][k]},
          {of.per_t[0][k], of.per_t[1][k], of.per_t[2][k]}};
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
