// How a surface that a ray has met answers: the twin of the fragment shader of RasterSampler.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "renderer/scene/world.hpp"
#include "renderer/visibility/normal_pyramid.hpp"
#include "renderer/visibility/ray_packet.hpp"
#include "renderer/visibility/sampler.hpp"

namespace sonard::render {

/// Shades what rays meet of one part.
class SurfaceShader {
 public:
  /// @param map of the part; null when it has none.
  SurfaceShader(const BodyPart& part, std::shared_ptr<const NormalPyramid> map);

  /// @param mesh with the attributes of the one before.
  void set_mesh(std::shared_ptr<const TriangleMesh> mesh) { mesh_ = std::move(mesh); }

  /// Sets the part's axes in the world.
  void turn(const glm::dquat& R_world_part);
  const std::array<glm::vec3, 3>& axes() const { return axes_; }

  /// Fills normal and response of the lanes that hit part number `part`, this one.
  void shade(const RayPacket& rays, const RayHits& hits, std::uint32_t part, const SurfaceModel& model,
             SurfacePacket& surfaces) const;

 private:
  enum class Normals { of_triangles, of_vertices, of_map };
  struct ShadingNormals;

  void look_up_normals(const RayPacket& rays, const RayHits& hits, std::uint32_t part,
                       ShadingNormals& normals) const;
  void apply_paper(const RayPacket& rays, const RayHits& hits, std::uint32_t part, const SurfaceModel& model,
                   SurfacePacket& surfaces) const;
  void add_facets(const RayHits& hits, std::uint32_t part, Facets which, const ShadingNormals& normals,
                  const Lanes<float>& cosine, SurfacePacket& surfaces) const;
  glm::vec3 vertex_normal(std::uint32_t triangle, float u, float v) const;
  glm::vec3 mapped_normal(const RayPacket& rays, const RayHits& hits, std::size_t lane) const;
  float map_level(const RayPacket& rays, const RayHits& hits, std::size_t lane) const;
  glm::vec3 to_part(const glm::vec3& v_world) const;

  std::shared_ptr<const TriangleMesh> mesh_;
  std::shared_ptr<const NormalPyramid> map_;
  Normals normals_;
  float reflectance_;
  Backscatter backscatter_;
  std::array<glm::vec3, 3> axes_{};  // of the part, in the world
};

}  // namespace sonard::render
