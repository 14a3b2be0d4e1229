// SPDX-License-Identifier: Apache-2.0
// A part of a body for RasterSampler: chunks of its mesh in OpenSceneGraph, and the input of
// surface_shader.hpp for its surface.
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

/// Input of the shader for the surface of a part. Parts with the same surface share one.
struct Surface {
  osg::ref_ptr<osg::StateSet> state;
  Shading shading;
  std::unique_ptr<NormalMapTexture> normal_map;  ///< null: no map
};

Surface make_surface(const BodyPart& part);
bool same_surface(const BodyPart& a, const BodyPart& b);

/// @param surface of this part
/// @param max_range_m must outlive the node; chunks beyond its value are not drawn
osg::ref_ptr<osg::MatrixTransform> make_part(const BodyPart& part, const Surface& surface,
                                             const float* max_range_m);

}  // namespace sonard::render
