// SPDX-License-Identifier: Apache-2.0
// Response of a surface that a ray hits: the counterpart of the fragment shader of RasterSampler.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include <glm/vec3.hpp>

#include "renderer/scene/world.hpp"
#include "renderer/spatial_index/ray_packet.hpp"
#include "renderer/surface/normal_pyramid.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

/// The surfaces that the rays of a packet hit. The surface point of a lane is depth * q. If depth is 0, the
/// other numbers are undefined.
struct alignas(64) SurfacePacket {
  Lanes<float> depth;  ///< 0: no hit up to the requested depth
  /// Geometric normal in world axes, of any length and sign.
  Lanes<float> normal_x, normal_y, normal_z;
  Lanes<float> response;  ///< see SurfaceModel; may be NaN
};

/// Shades the hits of one part.
class SurfaceShader {
 public:
  /// @param map of the part; null if it has no map
  SurfaceShader(const BodyPart& part, std::shared_ptr<const NormalPyramid> map);

  /// @param mesh with the same attributes as the last one
  /// @param axes of the part in the world
  void place(const std::shared_ptr<const TriangleMesh>& mesh, const std::array<glm::vec3, 3>& axes) {
    mesh_ = mesh;
    axes_ = axes;
  }

  /// Fills normal and response of the lanes that hit this part. @param part its number
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
