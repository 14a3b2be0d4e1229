// SPDX-License-Identifier: Apache-2.0
// Neighbouring triangles of a mesh, the unit of culling, drawing and video memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <osg/BoundingBox>
#include <osg/Drawable>
#include <osg/Group>
#include <osg/State>

#include "renderer/engines/gpu/video_memory.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Locations of the attributes of a vertex in surface_shader.hpp; `attribute_floats` are their sizes.
enum VertexAttribute : unsigned {
  position_attribute,
  normal_attribute,
  texcoord_attribute,
  tangent_attribute,
  facet_attribute  ///< plane of the triangle that ends with the vertex, one at most: unit normal n, and n.p
                   ///< of its points p from the centre of the chunk
};
inline constexpr std::array<int, 5> attribute_floats{3, 3, 2, 4, 4};

/// The bytes of a chunk for the upload: array after array, then three 16-bit indices per triangle.
struct ChunkBytes {
  static constexpr std::size_t none = ~std::size_t{0};

  std::vector<std::uint8_t> bytes;
  /// none: the mesh has no such attribute
  std::array<std::size_t, attribute_floats.size()> attribute_begin{none, none, none, none, none};
  std::size_t index_begin = 0;
  int index_count = 0;
  osg::BoundingBox box;
};

/// Drawn only while it is in video memory: see VideoMemory::hold().
class MeshChunk final : public osg::Drawable, public VideoMemory::Item {
 public:
  explicit MeshChunk(ChunkBytes content);

  osg::BoundingBox computeBoundingBox() const override { return content_.box; }
  void drawImplementation(osg::RenderInfo& info) const override;
  /// In coordinates of the part.
  osg::Vec3d centre() const { return content_.box.center(); }
  std::uint64_t triangles() const { return static_cast<std::uint64_t>(content_.index_count) / 3; }

 private:
  ~MeshChunk() override { remove(); }
  void upload(osg::State& state) override;
  void release(osg::State& state) override;

  const ChunkBytes content_;
  GLuint buffer_ = 0;
  GLuint vertex_array_ = 0;  ///< places of attributes and indices in the buffer
};

/// Adds the triangles of a mesh to the node of their part.
/// @param max_range_m must outlive the node; chunks beyond its value are not drawn
void add_chunks(const TriangleMesh& mesh, const float* max_range_m, osg::Group& part);

}  // namespace sonard::render
