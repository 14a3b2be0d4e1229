// SPDX-License-Identifier: Apache-2.0
// What slices know of the surface of one part of a body.
#pragma once

#include <memory>

#include <glm/mat3x3.hpp>

#include "renderer/scene/refraction.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/surface/backscatter.hpp"
#include "renderer/surface/normal_pyramid.hpp"

namespace sonard::render {

/// How the surface of one part answers.
struct PartSurface {
  std::shared_ptr<const TriangleMesh> mesh;
  std::shared_ptr<const NormalPyramid> normal_map;  ///< null: none, or switched off
  bool vertex_normals = false;                      ///< whether shading interpolates them
  Backscatter backscatter;
  float reflectance = 0.0F;
  // For this ping:
  glm::mat3 R_part_sonar{1.0F};
  Refraction refraction_in_part;  ///< `up` in the axes of the part
};

}  // namespace sonard::render
