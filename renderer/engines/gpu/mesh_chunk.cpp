// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/mesh_chunk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <osg/Array>
#include <osg/GLExtensions>
#include <osg/PrimitiveSet>
#include <osg/State>

namespace sonard::render {

namespace {

constexpr std::size_t chunk_triangles = 2048;  // unit of culling by view and range
static_assert(3 * chunk_triangles <= std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1,
              "its indices have 16 bits");
constexpr std::uint32_t none = ~std::uint32_t{0};

// Locations in surface.vert.
enum VertexAttribute : unsigned {
  position_attribute,
  normal_attribute,
  texcoord_attribute,
  tangent_attribute,
  facet_attribute  // plane of the triangle that ends with the vertex, one at most: unit normal n, and n.p of
                   // its points p from the centre of the chunk
};
constexpr int eye_uniform = 0;

struct Triangle {
  glm::vec3 centre;
  std::uint32_t number;
};

/// Splits triangles into compact groups by halving along the longest side.
void split(std::span<Triangle> triangles, const std::function<void(std::span<Triangle>)>& add) {
  if (triangles.size() <= chunk_triangles) {
    add(triangles);
    return;
  }
  glm::vec3 low(INFINITY);
  glm::vec3 high(-INFINITY);
  for (const Triangle& triangle : triangles) {
    low = glm::min(low, triangle.centre);
    high = glm::max(high, triangle.centre);
  }
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const std::size_t middle = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(middle),
                   triangles.end(), [axis](const Triangle& a, const Triangle& b) {
                     return std::pair(a.centre[axis], a.number) < std::pair(b.centre[axis], b.number);
                   });
  split(triangles.first(middle), add);
  split(triangles.subspan(middle), add);
}

/// Makes chunks of groups of triangles.
class ChunkBuilder {
 public:
  explicit ChunkBuilder(const TriangleMesh& mesh)
      : mesh_(mesh), number_in_chunk_(mesh.positions.size(), none) {}

  osg::ref_ptr<MeshChunk> build(std::span<Triangle> triangles) {
    // In the order of the mesh, in which neighbours mostly follow one another: OpenGL computes a shared
    // corner once if its triangles follow soon after each other.
    std::ranges::sort(triangles, {}, &Triangle::number);
    vertices_.clear();
    ending_facets_.clear();
    osg::ref_ptr<osg::DrawElementsUShort> indices = new osg::DrawElementsUShort(GL_TRIANGLES);
    for (const Triangle& triangle : triangles) {
      const std::array<std::uint32_t, 3> corners = corners_of(triangle.number);
      indices->insert(indices->end(), corners.begin(), corners.end());
    }
    for (const std::uint32_t vertex : vertices_) {
      number_in_chunk_[vertex] = none;
    }
    osg::ref_ptr<MeshChunk> chunk = new MeshChunk;
    chunk->addPrimitiveSet(indices);
    add<osg::Vec3Array>(mesh_.positions, position_attribute, *chunk);
    add<osg::Vec3Array>(mesh_.normals, normal_attribute, *chunk);
    add<osg::Vec2Array>(mesh_.texcoords, texcoord_attribute, *chunk);
    add<osg::Vec4Array>(mesh_.tangents, tangent_attribute, *chunk);
    add_facets(*chunk);
    return chunk;
  }

 private:
  /// Of a triangle, counted in the chunk. The triangle ends with a corner with which no other triangle ends,
  /// or with a copy of a corner.
  std::array<std::uint32_t, 3> corners_of(std::uint32_t triangle) {
    std::array<std::uint32_t, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t vertex = mesh_.indices[std::size_t{triangle} * 3 + i];
      std::uint32_t& number = number_in_chunk_[vertex];
      number = number == none ? add_vertex(vertex) : number;
      corners[i] = number;
    }
    const auto free = std::ranges::find_if(corners, [&](auto i) { return ending_facets_[i] == none; });
    if (free != corners.end()) {
      std::rotate(corners.begin(), free + 1, corners.end());
    } else {
      corners[2] = add_vertex(vertices_[corners[2]]);
    }
    ending_facets_[corners[2]] = triangle;
    return corners;
  }

  std::uint32_t add_vertex(std::uint32_t vertex) {
    vertices_.push_back(vertex);
    ending_facets_.push_back(none);
    return static_cast<std::uint32_t>(vertices_.size() - 1);
  }

  template <class Array, class Value>
  void add(const std::vector<Value>& of_mesh, VertexAttribute attribute, MeshChunk& chunk) const {
    if (of_mesh.empty()) {
      return;
    }
    osg::ref_ptr<Array> values = new Array(static_cast<unsigned>(vertices_.size()));
    static_assert(sizeof(Value) == sizeof(typename Array::ElementDataType));
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      std::memcpy((*values)[i].ptr(), &of_mesh[vertices_[i]], sizeof(Value));
    }
    chunk.setVertexAttribArray(attribute, values, osg::Array::BIND_PER_VERTEX);
  }

  void add_facets(MeshChunk& chunk) const {
    const osg::Vec3d centre = chunk.getBoundingBox().center();
    osg::ref_ptr<osg::Vec4Array> planes = new osg::Vec4Array;
    for (const std::uint32_t facet : ending_facets_) {
      planes->push_back(facet == none ? osg::Vec4() : plane_of(facet, {centre.x(), centre.y(), centre.z()}));
    }
    chunk.setVertexAttribArray(facet_attribute, planes, osg::Array::BIND_PER_VERTEX);
  }

  /// Plane of a triangle, see facet_attribute; zero if it has no area.
  osg::Vec4 plane_of(std::uint32_t triangle, const glm::dvec3& centre) const {
    const std::uint32_t* corner = &mesh_.indices[std::size_t{triangle} * 3];
    const glm::dvec3 a = mesh_.positions[corner[0]];
    const glm::dvec3 across =
        glm::cross(glm::dvec3(mesh_.positions[corner[1]]) - a, glm::dvec3(mesh_.positions[corner[2]]) - a);
    const double length = glm::length(across);
    const glm::dvec3 n = across / length;
    return length > 0.0 ? osg::Vec4d(n.x, n.y, n.z, glm::dot(n, a - centre)) : osg::Vec4d();
  }

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> number_in_chunk_;  // per vertex of the mesh
  std::vector<std::uint32_t> vertices_;         // of the mesh, per vertex of the chunk
  std::vector<std::uint32_t> ending_facets_;    // of the mesh, per vertex of the chunk
};

}  // namespace

MeshChunk::MeshChunk() {
  setUseDisplayList(false);
  setUseVertexBufferObjects(true);
}

void MeshChunk::drawImplementation(osg::RenderInfo& info) const {
  const osg::Matrixd rounded = osg::Matrixf(info.getState()->getModelViewMatrix());  // as in the shader
  const osg::Vec3 eye = osg::Matrixd::inverse(rounded).getTrans() - osg::Vec3d(getBoundingBox().center());
  info.getState()->get<osg::GLExtensions>()->glUniform3f(eye_uniform, eye.x(), eye.y(), eye.z());
  osg::Geometry::drawImplementation(info);
}

std::uint64_t MeshChunk::bytes() const {
  std::uint64_t bytes = getPrimitiveSet(0)->getTotalDataSize();
  for (const auto& attribute : getVertexAttribArrayList()) {
    bytes += attribute ? attribute->getTotalDataSize() : 0;
  }
  return bytes;
}

osg::ref_ptr<osg::Group> make_chunks(const TriangleMesh& mesh, osg::Drawable::CullCallback* culling) {
  osg::ref_ptr<osg::Group> chunks = new osg::Group;
  std::vector<Triangle> triangles;
  for (std::uint32_t triangle = 0; triangle < mesh.triangle_count(); ++triangle) {
    const std::uint32_t* corner = &mesh.indices[std::size_t{triangle} * 3];
    triangles.push_back(
        {(mesh.positions[corner[0]] + mesh.positions[corner[1]] + mesh.positions[corner[2]]) / 3.0F,
         triangle});
  }
  ChunkBuilder builder(mesh);
  split(triangles, [&](std::span<Triangle> of_chunk) {
    if (!of_chunk.empty()) {
      const osg::ref_ptr<MeshChunk> chunk = builder.build(of_chunk);
      chunk->setCullCallback(culling);
      chunks->addChild(chunk);
    }
  });
  return chunks;
}

}  // namespace sonard::render
