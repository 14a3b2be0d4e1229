// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/raster_part.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <unordered_map>

#include <osg/Geometry>
#include <osg/Image>
#include <osg/Texture2D>
#include <osgUtil/CullVisitor>

#include "renderer/surface/backscatter.hpp"
#include "renderer/surface/normal_pyramid.hpp"

namespace sonard::render {

namespace {

constexpr std::size_t chunk_triangles = 2048;  // what culling by view and range works on
constexpr unsigned tangent_attribute = 6;

/// Culls a chunk that lies wholly beyond the range of the sonar.
class RangeCull : public osg::DrawableCullCallback {
 public:
  explicit RangeCull(const ChunkDrawing& drawing) : drawing_(drawing) {}

  bool cull(osg::NodeVisitor* visitor, osg::Drawable* drawable, osg::RenderInfo* /*info*/) const override {
    const osg::Vec3 eye = static_cast<osgUtil::CullVisitor*>(visitor)->getEyeLocal();
    const osg::BoundingBox& box = drawable->getBoundingBox();
    const osg::Vec3 nearest(std::clamp(eye.x(), box.xMin(), box.xMax()),
                            std::clamp(eye.y(), box.yMin(), box.yMax()),
                            std::clamp(eye.z(), box.zMin(), box.zMax()));
    return (nearest - eye).length() > drawing_.max_range_m;
  }

 private:
  const ChunkDrawing& drawing_;
};

/// Draws a chunk and counts it.
class CountedDraw : public osg::Drawable::DrawCallback {
 public:
  CountedDraw(ChunkDrawing& drawing, std::size_t triangles) : drawing_(drawing), triangles_(triangles) {}

  void drawImplementation(osg::RenderInfo& info, const osg::Drawable* drawable) const override {
    ++drawing_.chunks;
    drawing_.triangles += triangles_;
    drawable->drawImplementation(info);
  }

 private:
  ChunkDrawing& drawing_;
  std::size_t triangles_;
};

/// Splits the triangles of a mesh into compact chunks by halving along the longest side.
class ChunkBuilder {
 public:
  explicit ChunkBuilder(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangle_count()) {
    std::iota(order_.begin(), order_.end(), 0U);
  }

  template <class AddChunk>
  void split(AddChunk add_chunk) {
    split(0, order_.size(), add_chunk);
  }

 private:
  glm::vec3 centre(std::uint32_t triangle) const {
    const std::uint32_t* corner = &mesh_.indices[std::size_t{triangle} * 3];
    return (mesh_.positions[corner[0]] + mesh_.positions[corner[1]] + mesh_.positions[corner[2]]) / 3.0F;
  }

  template <class AddChunk>
  void split(std::size_t begin, std::size_t end, AddChunk& add_chunk) {
    if (end - begin <= chunk_triangles) {
      add_chunk(std::span<const std::uint32_t>(order_).subspan(begin, end - begin));
      return;
    }
    glm::vec3 low(INFINITY);
    glm::vec3 high(-INFINITY);
    for (std::size_t i = begin; i < end; ++i) {
      low = glm::min(low, centre(order_[i]));
      high = glm::max(high, centre(order_[i]));
    }
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      const float ca = centre(a)[axis];
      const float cb = centre(b)[axis];
      return ca < cb || (ca == cb && a < b);
    });
    split(begin, middle, add_chunk);
    split(middle, end, add_chunk);
  }

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> order_;
};

osg::ref_ptr<osg::Geometry> make_geometry(const TriangleMesh& mesh,
                                          std::span<const std::uint32_t> triangles) {
  osg::ref_ptr<osg::Vec3Array> positions = new osg::Vec3Array;
  osg::ref_ptr<osg::Vec3Array> normals = new osg::Vec3Array;
  osg::ref_ptr<osg::Vec2Array> texcoords = new osg::Vec2Array;
  osg::ref_ptr<osg::Vec4Array> tangents = new osg::Vec4Array;
  osg::ref_ptr<osg::DrawElementsUInt> elements = new osg::DrawElementsUInt(GL_TRIANGLES);
  std::unordered_map<std::uint32_t, unsigned> local_index;
  for (const std::uint32_t triangle : triangles) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t v = mesh.indices[std::size_t{triangle} * 3 + corner];
      const auto [entry, is_new] = local_index.try_emplace(v, static_cast<unsigned>(positions->size()));
      elements->push_back(entry->second);
      if (!is_new) {
        continue;
      }
      const glm::vec3& p = mesh.positions[v];
      positions->push_back(osg::Vec3(p.x, p.y, p.z));
      if (!mesh.normals.empty()) {
        normals->push_back(osg::Vec3(mesh.normals[v].x, mesh.normals[v].y, mesh.normals[v].z));
      }
      if (!mesh.texcoords.empty()) {
        texcoords->push_back(osg::Vec2(mesh.texcoords[v].x, mesh.texcoords[v].y));
      }
      if (!mesh.tangents.empty()) {
        const glm::vec4& t = mesh.tangents[v];
        tangents->push_back(osg::Vec4(t.x, t.y, t.z, t.w));
      }
    }
  }
  osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
  geometry->setUseDisplayList(false);
  geometry->setUseVertexBufferObjects(true);
  geometry->setVertexArray(positions);
  if (!normals->empty()) {
    geometry->setNormalArray(normals, osg::Array::BIND_PER_VERTEX);
  }
  if (!texcoords->empty()) {
    geometry->setTexCoordArray(0, texcoords, osg::Array::BIND_PER_VERTEX);
  }
  if (!tangents->empty()) {
    geometry->setVertexAttribArray(tangent_attribute, tangents, osg::Array::BIND_PER_VERTEX);
  }
  geometry->addPrimitiveSet(elements);
  return geometry;
}

/// The texels of all levels, as surface_shader.hpp reads them, and where the levels are.
void add_normal_map(const NormalMap& map, osg::StateSet& state) {
  const NormalPyramid pyramid(map);
  constexpr std::size_t row_texels = 4096;
  const std::size_t rows = (pyramid.texels.size() + row_texels - 1) / row_texels;
  osg::ref_ptr<osg::Image> image = new osg::Image;
  image->allocateImage(row_texels, static_cast<int>(rows), 1, GL_RGBA_INTEGER_EXT, GL_SHORT);
  std::memcpy(image->data(), pyramid.texels.data(), pyramid.texels.size() * sizeof(NormalPyramid::Texel));
  osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D(image);
  texture->setInternalFormat(GL_RGBA16I_EXT);
  texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::NEAREST);
  texture->setFilter(osg::Texture::MAG_FILTER, osg::Texture::NEAREST);
  texture->setResizeNonPowerOfTwoHint(false);
  state.setTextureAttributeAndModes(normal_map_unit, texture);

  const auto level_count = static_cast<int>(pyramid.levels.size());
  osg::ref_ptr<osg::Uniform> levels = new osg::Uniform(osg::Uniform::INT_VEC3, "map_levels", level_count);
  for (int i = 0; i < level_count; ++i) {
    const NormalPyramid::Level& level = pyramid.levels[static_cast<std::size_t>(i)];
    levels->setElement(static_cast<unsigned>(i), level.width_px, level.height_px,
                       static_cast<int>(level.first_texel));
  }
  state.addUniform(levels);
  state.addUniform(new osg::Uniform("map_level_count", level_count));
}

}  // namespace

Shading shading_of(const BodyPart& part) {
  if (part.normal_map && part.mesh->can_be_mapped()) {
    return Shading::normal_mapped;
  }
  return part.mesh->normals.empty() ? Shading::geometric_normal : Shading::vertex_normals;
}

osg::Matrixd to_osg(const Pose& T_a_b) {
  const glm::dquat& q = T_a_b.orientation;
  return osg::Matrixd::rotate(osg::Quat(q.x, q.y, q.z, q.w)) *
         osg::Matrixd::translate(T_a_b.position_m.x, T_a_b.position_m.y, T_a_b.position_m.z);
}

void add_chunks(const TriangleMesh& mesh, ChunkDrawing& drawing, osg::Group& part) {
  if (mesh.indices.empty()) {
    return;
  }
  ChunkBuilder(mesh).split([&](std::span<const std::uint32_t> triangles) {
    osg::ref_ptr<osg::Geometry> chunk = make_geometry(mesh, triangles);
    chunk->setCullCallback(new RangeCull(drawing));
    chunk->setDrawCallback(new CountedDraw(drawing, triangles.size()));
    part.addChild(chunk);
  });
}

bool same_surface(const BodyPart& a, const BodyPart& b) {
  return a.material == b.material && a.normal_map == b.normal_map && shading_of(a) == shading_of(b);
}

osg::ref_ptr<osg::StateSet> make_surface(const BodyPart& part) {
  osg::ref_ptr<osg::StateSet> state = new osg::StateSet;
  if (shading_of(part) == Shading::normal_mapped) {
    add_normal_map(*part.normal_map, *state);
  }
  state->addUniform(new osg::Uniform("reflectance", static_cast<float>(part.material.reflectance)));
  const Backscatter backscatter(part.material);
  state->addUniform(new osg::Uniform("lambert_mu", backscatter.lambert_mu));
  state->addUniform(new osg::Uniform("facet_strength", backscatter.facet_strength));
  state->addUniform(new osg::Uniform("slope_variance", backscatter.slope_variance));
  state->addUniform(new osg::Uniform("facets_least_cosine", backscatter.least_cosine));
  return state;
}

osg::ref_ptr<osg::MatrixTransform> make_part(const BodyPart& part, osg::StateSet* surface,
                                             ChunkDrawing& drawing) {
  osg::ref_ptr<osg::MatrixTransform> node = new osg::MatrixTransform(to_osg(part.T_body_part));
  node->setStateSet(surface);
  add_chunks(*part.mesh, drawing, *node);
  return node;
}

}  // namespace sonard::render
