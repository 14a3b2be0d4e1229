// SPDX-License-Identifier: Apache-2.0
// The normals that shade segments, interpolated from vertex normals.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "renderer/engines/cpu/fan_triangles.hpp"
#include "renderer/engines/cpu/slice_sweep.hpp"
#include "renderer/engines/slices/part_surface.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// The normal that shades the plane of a triangle at the hit of the ray (1, x, t) of a slice: at + per_x x +
/// per_t t, of any length and sign. Components are along the slice, across it to port, and up. Exact, because
/// the weights of corners, divided by the depth, are affine in x and t. Beside the triangle it extrapolates.
struct NormalRun {
  glm::vec3 at, per_x{0.0F}, per_t{0.0F};

  bool is_finite() const {
    return std::isfinite(glm::dot(at, at) + glm::dot(per_x, per_x) + glm::dot(per_t, per_t));
  }
};

/// Interpolates the normals of all triangles of a ping, once, for all slices that see them.
class VertexNormals {
 public:
  /// Triangles of parts without vertex normals are left out.
  void find(const FanTriangles& triangles, const std::vector<PartSurface>& parts, WorkerPool& workers);

  /// The run of a triangle of find() in a slice, without refraction; not finite if the triangle is
  /// degenerate.
  NormalRun run(const FanTriangle& triangle, const Slice& slice) const;

 private:
  static constexpr std::size_t lanes = 16;
  /// Corners of `lanes` triangles, one array per number.
  struct Corners {
    float position[3][3][lanes];  ///< [corner][axis], sonar frame
    float normal[3][3][lanes];

    void set(std::size_t lane, const PartSurface& part, const FanTriangle& triangle);
  };
  /// The normal at the hit of a ray d is column[0] d.x + column[1] d.y + column[2] d.z, in the sonar frame.
  struct Fields {
    float column[3][3][lanes];  ///< [column][axis]
  };
  void find_some(std::span<const FanTriangle> triangles, const std::vector<PartSurface>& parts);
  static void interpolate_lanes(const Corners& from, Fields& to);

  std::vector<glm::mat3> fields_;  ///< by FanTriangle::number
};

/// Turns a run by the refraction at `t` of the slice.
void refract(const PartSurface& part, const VisibleSegment& segment, const Slice& slice, float t,
             NormalRun& run);

}  // namespace sonard::render
