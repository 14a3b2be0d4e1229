// SPDX-License-Identifier: Apache-2.0
// Surface of one part of a body, for slices.
#pragma once

#include <memory>

#include <glm/mat3x3.hpp>

#include "renderer/scene/refraction.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/surface/backscatter.hpp"
#include "renderer/surface/normal_pyramid.hpp"

namespace sonard::render {

/// Acoustic response of the surface of one part.
struct PartSurface {
  std::shared_ptr<const TriangleMesh> mesh;
  std::shared_ptr<const NormalPyramid> normal_map;  ///< null: no map, or switched off
  bool vertex_normals = false;                      ///< shading interpolates vertex normals
  Backscatter backscatter;
  float reflectance = 0.0F;
  // For this ping:
  glm::mat3 R_part_sonar{1.0F};
  Refraction refraction_in_part;  ///< `up` in the axes of the part
};

}  // namespace sonard::render
