// SPDX-License-Identifier: Apache-2.0
// The normals that shade segments, interpolated from vertex normals.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "renderer/engines/cpu/part_surface.hpp"
#include "renderer/engines/cpu/slice_sweep.hpp"

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

/// Interpolates the normals of many triangles in one loop. One per thread; reuses its memory.
class VertexNormals {
 public:
  void clear() { count_ = 0; }
  /// @param part of the triangle; must have vertex normals
  void add(const PartSurface& part, const FanTriangle& triangle);
  std::size_t count() const { return count_; }

  /// Finds all runs, without refraction.
  void interpolate(const Slice& slice);
  /// The run of triangle `i`, in the order of add(); not finite for degenerate triangles.
  NormalRun run(std::size_t i) const;

 private:
  static constexpr std::size_t lanes = 16;
  /// Corners of `lanes` triangles, one array per number.
  struct Corners {
    float position[3][3][lanes];  ///< [corner][axis], sonar frame
    float normal[3][3][lanes];
  };
  struct Runs {
    float at[3][lanes], per_x[3][lanes], per_t[3][lanes];
  };
  static void interpolate_lanes(const Slice& slice, const Corners& from, Runs& to);

  std::vector<Corners> corners_;
  std::vector<Runs> runs_;
  std::size_t count_ = 0;
};

/// Turns a run by the refraction at `t` of the slice.
void refract(const PartSurface& part, const VisibleSegment& segment, const Slice& slice, float t,
             NormalRun& run);

}  // namespace sonard::render
