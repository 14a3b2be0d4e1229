// SPDX-License-Identifier: Apache-2.0
// A normal map averaged over the area of a sample. Both engines use the same arithmetic, in C++ and GLSL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Levels of a normal map, each half as wide and high as the previous one, down to one texel. A texel holds
/// the MEAN of the unit normals below it, and is not normalised. An echo is proportional to n.d, so the mean
/// echo of an area is the echo of its mean normal. (With unit normals, a rough surface would echo like a
/// smooth one if samples are coarser than its bumps.)
struct NormalPyramid {
  struct Level {
    int width_px = 0;
    int height_px = 0;
    std::size_t first_texel = 0;
  };
  /// Components times 32767; the fourth is padding. GL's format RGBA16_SNORM.
  using Texel = std::array<std::int16_t, 4>;

  std::vector<Level> levels;
  std::vector<Texel> texels;  ///< level after level, row 0 at v = 0

  explicit NormalPyramid(const NormalMap& map);
  /// The pyramid of a surface without bumps. An 8-bit map cannot represent it exactly.
  static NormalPyramid straight();

  /// Mean normal around `uv` (repeated beyond [0, 1]) over 2^level texels, linear between texels and between
  /// levels. `level` is clamped to the existing levels.
  glm::vec3 mean_normal(const glm::vec2& uv, float level) const;

 private:
  NormalPyramid() = default;
  glm::vec3 bilinear(const Level& level, const glm::vec2& uv) const;
};

/// Transforms a mapped normal `m` to the coordinates of the part. `vertex_normal` may have any length;
/// `tangent` is as in TriangleMesh, interpolated. The length of `m` is kept.
glm::vec3 from_tangent_frame(const glm::vec3& m, const glm::vec3& vertex_normal, const glm::vec4& tangent);

}  // namespace sonard::render
