// SPDX-License-Identifier: Apache-2.0
// A part of a body as RasterSampler draws it: chunks of its mesh in OpenSceneGraph, and what
// surface_shader.hpp wants to know of its surface.
#pragma once

#include <cstdint>

#include <osg/MatrixTransform>
#include <osg/Matrixd>
#include <osg/StateSet>

#include "renderer/engines/gpu/surface_shader.hpp"
#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Texture unit of normal maps.
inline constexpr int normal_map_unit = 0;

osg::Matrixd to_osg(const Pose& T_a_b);

/// What all chunks of a world share.
struct ChunkDrawing {
  float max_range_m = 0.0F;  ///< chunks beyond it are not drawn
  // So much has been drawn since the beginning.
  std::uint64_t chunks = 0;
  std::uint64_t triangles = 0;
};

/// Adds the triangles of a mesh to the node of their part.
/// @param drawing outlives the node.
void add_chunks(const TriangleMesh& mesh, ChunkDrawing& drawing, osg::Group& part);

Shading shading_of(const BodyPart& part);

/// What the shader wants to know of the surface of a part. Parts with the same surface share one.
osg::ref_ptr<osg::StateSet> make_surface(const BodyPart& part);
bool same_surface(const BodyPart& a, const BodyPart& b);

/// @param drawing outlives the node.
osg::ref_ptr<osg::MatrixTransform> make_part(const BodyPart& part, osg::StateSet* surface,
                                             ChunkDrawing& drawing);

}  // namespace sonard::render
