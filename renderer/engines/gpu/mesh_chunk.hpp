// SPDX-License-Identifier: Apache-2.0
// Neighbouring triangles of a mesh, the unit of culling, drawing and video memory of RasterSampler.
#pragma once

#include <cstddef>
#include <cstdint>

#include <osg/Drawable>
#include <osg/Geometry>
#include <osg/Group>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// For the shader surface.vert. In coordinates of the part.
class MeshChunk final : public osg::Geometry {
 public:
  MeshChunk();

  /// Draws with the current program, and gives it the eye relative to the centre of the chunk.
  void drawImplementation(osg::RenderInfo& info) const override;
  /// Of vertices and indices in video memory.
  std::uint64_t bytes() const;
};

/// The chunks of a mesh.
/// @param culling of each chunk
osg::ref_ptr<osg::Group> make_chunks(const TriangleMesh& mesh, osg::Drawable::CullCallback* culling);

}  // namespace sonard::render
