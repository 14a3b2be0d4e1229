// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/mesh_chunk.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include <osg/GLExtensions>
#include <osgUtil/CullVisitor>

namespace sonard::render {

namespace {

constexpr std::size_t chunk_triangles = 2048;  // unit of culling by view and range
static_assert(3 * chunk_triangles <= std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1,
              "its indices have 16 bits");

/// Culls a chunk that lies wholly beyond the range of the sonar.
class RangeCull : public osg::DrawableCullCallback {
 public:
  explicit RangeCull(const float* max_range_m) : max_range_m_(max_range_m) {}

  bool cull(osg::NodeVisitor* visitor, osg::Drawable* drawable, osg::RenderInfo* /*info*/) const override {
    const osg::Vec3 eye = static_cast<osgUtil::CullVisitor*>(visitor)->getEyeLocal();
    const osg::BoundingBox& box = drawable->getBoundingBox();
    const osg::Vec3 nearest(std::clamp(eye.x(), box.xMin(), box.xMax()),
                            std::clamp(eye.y(), box.yMin(), box.yMax()),
                            std::clamp(eye.z(), box.zMin(), box.zMax()));
    return (nearest - eye).length() > *max_range_m_;
  }

 private:
  const float* max_range_m_;
};

/// Splits the triangles of a mesh into compact chunks by halving along the longest side.
class ChunkBuilder {
 public:
  explicit ChunkBuilder(const TriangleMesh& mesh)
      : mesh_(mesh), number_in_chunk_(mesh.positions.size(), none) {
    triangles_.reserve(mesh.triangle_count());
    for (std::uint32_t triangle = 0; triangle < mesh.triangle_count(); ++triangle) {
      const std::uint32_t* corner = &mesh.indices[std::size_t{triangle} * 3];
      triangles_.push_back(
          {(mesh.positions[corner[0]] + mesh.positions[corner[1]] + mesh.positions[corner[2]]) / 3.0F,
           triangle});
    }
  }

  template <class AddChunk>
  void split(AddChunk add_chunk) {
    split(triangles_, add_chunk);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  struct Triangle {
    glm::vec3 centre;
    std::uint32_t number;
  };

  template <class AddChunk>
  void split(std::span<Triangle> triangles, AddChunk& add_chunk) {
    if (triangles.size() <= chunk_triangles) {
      add_chunk(content_of(triangles));
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
    split(triangles.first(middle), add_chunk);
    split(triangles.subspan(middle), add_chunk);
  }

  ChunkBytes content_of(std::span<Triangle> triangles) {
    // In the order of the mesh, in which neighbours mostly follow one another: OpenGL computes a shared
    // corner once if its triangles follow soon after each other.
    std::ranges::sort(triangles, {}, &Triangle::number);
    std::vector<std::uint32_t> vertices;       // of the mesh
    std::vector<std::uint32_t> ending_facets;  // of the mesh, for each vertex
    std::vector<std::uint16_t> indices;
    ChunkBytes content;
    const auto add = [&](std::uint32_t vertex) {
      vertices.push_back(vertex);
      ending_facets.push_back(none);
      return static_cast<std::uint32_t>(vertices.size() - 1);
    };
    for (const Triangle& triangle : triangles) {
      std::array<std::uint32_t, 3> corners;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t vertex = mesh_.indices[std::size_t{triangle.number} * 3 + i];
        std::uint32_t& number = number_in_chunk_[vertex];
        if (number == none) {
          number = add(vertex);
          const glm::vec3& p = mesh_.positions[vertex];
          content.box.expandBy(p.x, p.y, p.z);
        }
        corners[i] = number;
      }
      // The triangle ends with a corner with which no other triangle ends, or with a copy of a corner.
      const auto free =
          std::find_if(corners.begin(), corners.end(), [&](auto i) { return ending_facets[i] == none; });
      if (free != corners.end()) {
        std::rotate(corners.begin(), free + 1, corners.end());
      } else {
        corners[2] = add(vertices[corners[2]]);
      }
      ending_facets[corners[2]] = triangle.number;
      indices.insert(indices.end(), corners.begin(), corners.end());
    }
    for (const std::uint32_t vertex : vertices) {
      number_in_chunk_[vertex] = none;
    }
    add_attribute(mesh_.positions, position_attribute, vertices, content);
    add_attribute(mesh_.normals, normal_attribute, vertices, content);
    add_attribute(mesh_.texcoords, texcoord_attribute, vertices, content);
    add_attribute(mesh_.tangents, tangent_attribute, vertices, content);
    add_facets(ending_facets, content);
    content.index_begin = append(indices, content.bytes);
    content.index_count = static_cast<int>(indices.size());
    return content;
  }

  void add_facets(const std::vector<std::uint32_t>& facets, ChunkBytes& content) const {
    const osg::Vec3d centre = content.box.center();
    std::vector<glm::vec4> planes;
    planes.reserve(facets.size());
    for (const std::uint32_t facet : facets) {
      planes.push_back(facet == none ? glm::vec4(0.0F)
                                     : plane_of(facet, {centre.x(), centre.y(), centre.z()}));
    }
    content.attribute_begin[facet_attribute] = append(planes, content.bytes);
  }

  /// Plane of a triangle, see facet_attribute; zero if it has no area.
  glm::vec4 plane_of(std::uint32_t triangle, const glm::dvec3& centre) const {
    const std::uint32_t* corner = &mesh_.indices[std::size_t{triangle} * 3];
    const glm::dvec3 a = mesh_.positions[corner[0]];
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(mesh_.positions[corner[1]]) - a, glm::dvec3(mesh_.positions[corner[2]]) - a);
    const double length = glm::length(normal);
    return length > 0.0 ? glm::vec4(normal / length, glm::dot(normal / length, a - centre)) : glm::vec4(0.0F);
  }

  template <class Value>
  static void add_attribute(const std::vector<Value>& of_mesh, VertexAttribute attribute,
                            const std::vector<std::uint32_t>& vertices, ChunkBytes& content) {
    if (of_mesh.empty()) {
      return;
    }
    std::vector<Value> values;
    values.reserve(vertices.size());
    for (const std::uint32_t vertex : vertices) {
      values.push_back(of_mesh[vertex]);
    }
    content.attribute_begin[attribute] = append(values, content.bytes);
  }

  /// @return begin of the values in `bytes`
  template <class Value>
  static std::size_t append(const std::vector<Value>& values, std::vector<std::uint8_t>& bytes) {
    const std::size_t begin = bytes.size();
    bytes.resize(begin + values.size() * sizeof(Value));
    std::memcpy(&bytes[begin], values.data(), values.size() * sizeof(Value));
    return begin;
  }

  const TriangleMesh& mesh_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> number_in_chunk_;  // per vertex of the mesh
};

const void* place_in_buffer(std::size_t byte) {
  return reinterpret_cast<const void*>(byte);
}

}  // namespace

MeshChunk::MeshChunk(ChunkBytes content) : Item(content.bytes.size()), content_(std::move(content)) {
  setUseDisplayList(false);
}

void MeshChunk::drawImplementation(osg::RenderInfo& info) const {
  assert(vertex_array_ != 0);
  osg::State& state = *info.getState();
  state.bindVertexArrayObject(vertex_array_);
  glDrawElements(GL_TRIANGLES, content_.index_count, GL_UNSIGNED_SHORT,
                 place_in_buffer(content_.index_begin));
  state.unbindVertexArrayObject();
}

void MeshChunk::upload(osg::State& state) {
  osg::GLExtensions& gl = *state.get<osg::GLExtensions>();
  gl.glGenBuffers(1, &buffer_);
  gl.glGenVertexArrays(1, &vertex_array_);
  state.bindVertexArrayObject(vertex_array_);
  gl.glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl.glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer_);  // the vertex array keeps this
  gl.glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes()), content_.bytes.data(), GL_STATIC_DRAW);
  for (unsigned i = 0; i < attribute_floats.size(); ++i) {
    if (content_.attribute_begin[i] != ChunkBytes::none) {
      gl.glVertexAttribPointer(i, attribute_floats[i], GL_FLOAT, GL_FALSE, 0,
                               place_in_buffer(content_.attribute_begin[i]));
      gl.glEnableVertexAttribArray(i);
    }
  }
  state.unbindVertexArrayObject();
  gl.glBindBuffer(GL_ARRAY_BUFFER, 0);
}

void MeshChunk::release(osg::State& state) {
  osg::GLExtensions& gl = *state.get<osg::GLExtensions>();
  gl.glDeleteVertexArrays(1, &vertex_array_);
  gl.glDeleteBuffers(1, &buffer_);
  vertex_array_ = buffer_ = 0;
}

void add_chunks(const TriangleMesh& mesh, const float* max_range_m, osg::Group& part) {
  if (mesh.indices.empty()) {
    return;
  }
  const osg::ref_ptr<RangeCull> range_cull = new RangeCull(max_range_m);
  ChunkBuilder(mesh).split([&](ChunkBytes content) {
    osg::ref_ptr<MeshChunk> chunk = new MeshChunk(std::move(content));
    chunk->setCullCallback(range_cull);
    part.addChild(chunk);
  });
}

}  // namespace sonard::render
