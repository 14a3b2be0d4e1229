// SPDX-License-Identifier: Apache-2.0
// The connected surfaces of a mesh that have an inner side which no sonar outside can see.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// One connected surface with two sides. Every ray from outside meets its outer side first, whichever way the
/// ray goes: a closed surface seen from out of its box, or a bed (one height for each x and y, over a convex
/// footprint) seen from above the footprint and the highest point.
struct Shell {
  enum class Kind : std::uint8_t { closed, bed };

  Kind kind = Kind::closed;
  /// 1: normals by the winding point to the outer side (outwards, up); -1: to the inner side.
  float outwards = 1.0F;
  glm::vec3 low_m{0.0F}, high_m{0.0F};  ///< box around it, in the frame of the mesh
  std::vector<glm::vec2> footprint_m;   ///< of a bed: corners of the convex outline, counter-clockwise

  /// Whether a sonar there sees the outer side only.
  /// @param sonar_m in the frame of the mesh
  bool hides_inner_side(const glm::vec3& sonar_m) const;
};

/// All shells of a mesh. Corners within 1e-6 of the mesh's extent are one corner, whatever their number. A
/// closed shell has two triangles at each edge, a bed has one at the edges of its outline.
class Shells {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  Shells() = default;
  explicit Shells(const TriangleMesh& mesh);

  std::span<const Shell> all() const { return shells_; }
  /// Index of the shell of a triangle; `none` if both of its sides may be seen.
  std::uint32_t of_triangle(std::size_t triangle) const { return shell_of_triangle_[triangle]; }

 private:
  std::vector<Shell> shells_;
  std::vector<std::uint32_t> shell_of_triangle_;
};

}  // namespace sonard::render
