// SPDX-License-Identifier: Apache-2.0
// A part of a body as RasterSampler draws it: chunks of its mesh in OpenSceneGraph, and what
// surface_shader.hpp wants to know of its surface.
#pragma once

#include <memory>

#include <osg/MatrixTransform>
#include <osg/Matrixd>
#include <osg/StateSet>

#include "renderer/engines/gpu/normal_map_texture.hpp"
#include "renderer/engines/gpu/surface_shader.hpp"
#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

osg::Matrixd to_osg(const Pose& T_a_b);

/// What the shader wants to know of the surface of a part. Parts with the same surface share one.
struct Surface {
  osg::ref_ptr<osg::StateSet> state;
  Shading shading;
  std::unique_ptr<NormalMapTexture> normal_map;  ///< null: none
};

Surface make_surface(const BodyPart& part);
bool same_surface(const BodyPart& a, const BodyPart& b);

/// @param surface of this part
/// @param max_range_m outlives the node: chunks beyond what it holds are not drawn.
osg::ref_ptr<osg::MatrixTransform> make_part(const BodyPart& part, const Surface& surface,
                                             const float* max_range_m);

}  // namespace sonard::render
