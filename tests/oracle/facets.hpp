// SPDX-License-Identifier: Apache-2.0
// A world as triangles in the sonar's frame, in double precision.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "tests/oracle/echo_law.hpp"

namespace sonard::oracle {

/// One triangle, metres, sonar frame. Triangles with a common vertex in a mesh have bit-identical corners.
struct Facet {
  std::array<glm::dvec3, 3> corners;
  glm::dvec3 normal;  ///< unit, geometric; (0, 0, 0) if the triangle has no area
  std::uint32_t part = 0;
  std::uint32_t mesh_triangle = 0;
};

/// All triangles of a world that the ping can meet, with their shading data. Immutable, so any number of
/// threads may read it.
class Facets {
 public:
  /// Transforms all geometry to the sonar frame in double precision. Leaves out triangles wholly beyond the
  /// range or wholly above or below the fan, and back faces if `law` is one-sided.
  Facets(const render::World& world, const render::Pose& T_world_sonar, const EchoLaw& law);

  const std::vector<Facet>& all() const { return facets_; }
  const Material& material(const Facet& facet) const { return parts_[facet.part].material; }

  /// Whether the shading normal varies over the facet.
  bool is_shaded(const Facet& facet) const { return parts_[facet.part].shading != Shading::geometric; }
  /// Length on which the shading normal may vary arbitrarily: a texel of the normal map. Infinite without a
  /// normal map.
  double detail_m(const Facet& facet) const;
  /// Unit normal for the echo law at `point` of the facet: geometric, interpolated between the vertices, or
  /// from a normal map (bilinear between texels, repeated).
  glm::dvec3 shading_normal(const Facet& facet, const glm::dvec3& point) const;

 private:
  enum class Shading { geometric, vertex_normals, normal_map };
  struct Part {
    std::shared_ptr<const render::TriangleMesh> mesh;
    std::shared_ptr<const render::NormalMap> normal_map;
    glm::dmat3 R_sonar_part;
    Material material;
    Shading shading;
  };

  void add_part(const render::BodyPart& part, const render::Pose& T_sonar_part, const EchoLaw& law);
  glm::dvec3 mapped_normal(const Part& part, const std::array<std::uint32_t, 3>& vertices,
                           const glm::dvec3& weights, const glm::dvec3& normal) const;

  std::vector<Part> parts_;
  std::vector<Facet> facets_;
};

/// The texture at (u, v), bilinear between texel centres at (i + 1/2) / size, repeated; 0 ... 1 per channel.
glm::dvec3 bilinear(const render::NormalMap& map, const glm::dvec2& uv);

}  // namespace sonard::oracle
