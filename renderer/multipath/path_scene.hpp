// SPDX-License-Identifier: Apache-2.0
// The world as the legs of a path meet it: meshes and the water surface, with how well each mirrors.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/multipath/mirror_law.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/spatial_index/spatial_index.hpp"

namespace sonard::render {

/// Where a leg of a path ends. Positions are relative to the sonar, in world axes, as everywhere here.
struct PathHit {
  glm::dvec3 position_m{0.0};
  double distance_m = 0.0;     ///< from where the leg began
  glm::dvec3 normal{0.0};      ///< unit, geometric, turned against the leg
  double cosine = 0.0;         ///< between leg and normal, in [0, 1]: the sine of the grazing angle
  std::uint32_t surface = 0;   ///< the part, counted through all bodies; no_part: the water surface
  std::uint32_t triangle = 0;  ///< of the part's mesh
};

/// The meshes of the world and above them the water surface, if the world has one and the sonar is below it.
/// place() comes from one thread while no other traces.
class PathScene {
 public:
  /// @param meshes outlives this object.
  explicit PathScene(SpatialIndex& meshes);

  /// @param water_surface its mirror.
  /// @throws RendererError when Embree fails.
  void place(const glm::dvec3& sonar_position_m, const Mirror& water_surface);

  /// The first surface along a unit direction. A leg that begins on a surface leaves it on the side of
  /// `normal`, which is that of the hit; {0} for the sonar itself.
  bool trace(const glm::dvec3& origin_m, const glm::dvec3& normal, const glm::dvec3& direction,
             double farthest_m, PathHit& hit) const;

  /// Traces neighbouring directions from the sonar, which share the work.
  /// @param hits where nothing is met, the distance is 0
  using Directions = std::array<glm::dvec3, packet_size>;
  void trace_from_sonar(const Directions& directions, double farthest_m,
                        std::array<PathHit, packet_size>& hits) const;

  /// Whether a straight leg from a surface reaches so far.
  bool is_free(const glm::dvec3& origin_m, const glm::dvec3& normal, const glm::dvec3& direction,
               double distance_m) const;
  /// Whether sound goes straight from a surface, from the side that was met, to the sonar. What is within
  /// 2 cm of the sonar does not hide it.
  bool sees_sonar(const PathHit& hit) const;

  const Mirror& mirror(const PathHit& hit) const {
    return hit.surface == no_part ? water_surface_ : surfaces_[hit.surface].mirror;
  }
  /// Lambert coefficient; 0 for the water surface, which scatters nothing back.
  double lambert_mu(const PathHit& hit) const {
    return hit.surface == no_part ? 0.0 : surfaces_[hit.surface].lambert_mu;
  }
  /// Of the facets that a rough surface has; those of the water surface are as under a light breeze.
  double rms_slope(const PathHit& hit) const {
    return hit.surface == no_part ? 0.1 : surfaces_[hit.surface].rms_slope;
  }
  /// False where the facet stands for part of a curved surface: its vertex normals are not its own.
  bool is_flat(const PathHit& hit) const;

 private:
  struct Surface {
    Mirror mirror;
    double lambert_mu;
    double rms_slope;
    std::shared_ptr<const TriangleMesh> mesh;
  };

  bool complete(const glm::vec3& start_m, const glm::dvec3& direction, double farthest_m,
                const SurfaceHit& met, PathHit& hit) const;

  SpatialIndex& meshes_;
  std::vector<Surface> surfaces_;        // of the parts, counted through all bodies
  std::optional<double> water_above_m_;  ///< height of the water surface over the sonar
  Mirror water_surface_;
};

}  // namespace sonard::render
