// SPDX-License-Identifier: Apache-2.0
// The surfaces that the legs of a path can hit, meshes and the water surface, and how well each mirrors.
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

/// The end of a leg of a path. All positions in multipath are relative to the sonar, in world axes.
struct PathHit {
  glm::dvec3 position_m{0.0};
  double distance_m = 0.0;     ///< from the start of the leg
  glm::dvec3 normal{0.0};      ///< unit, geometric, turned against the leg
  double cosine = 0.0;         ///< between leg and normal, in [0, 1]: the sine of the grazing angle
  std::uint32_t surface = 0;   ///< number of the part over all bodies; no_part: the water surface
  std::uint32_t triangle = 0;  ///< of the part's mesh
};

/// The meshes of the world, and the water surface if the world has one and the sonar is below it. place()
/// must not run while another thread traces.
class PathScene {
 public:
  /// @param meshes must outlive this object
  explicit PathScene(SpatialIndex& meshes);

  /// Sets the position of the sonar.
  /// @throws RendererError if Embree fails
  void place(const glm::dvec3& sonar_position_m, const Mirror& water_surface);

  /// Finds the first surface along a unit direction. A leg that begins on a surface leaves it on the side of
  /// `normal` (PathHit::normal); {0} if it begins at the sonar.
  bool trace(const glm::dvec3& origin_m, const glm::dvec3& normal, const glm::dvec3& direction,
             double farthest_m, PathHit& hit) const;

  /// Traces neighbouring directions from the sonar together.
  /// @param hits distance 0 if nothing is hit
  using Directions = std::array<glm::dvec3, packet_size>;
  void trace_from_sonar(const Directions& directions, double farthest_m,
                        std::array<PathHit, packet_size>& hits) const;

  /// True if a straight leg from a surface is free over `distance_m`.
  bool is_free(const glm::dvec3& origin_m, const glm::dvec3& normal, const glm::dvec3& direction,
               double distance_m) const;
  /// True if the straight line from a surface, from the side that was hit, to the sonar is free. Objects
  /// within 2 cm of the sonar do not hide it.
  bool sees_sonar(const PathHit& hit) const;

  const Mirror& mirror(const PathHit& hit) const {
    return hit.surface == no_part ? water_surface_ : surfaces_[hit.surface].mirror;
  }
  /// Lambert coefficient; 0 for the water surface, which scatters nothing back.
  double lambert_mu(const PathHit& hit) const {
    return hit.surface == no_part ? 0.0 : surfaces_[hit.surface].lambert_mu;
  }
  /// Slope of the facets of a rough surface; the water surface has the slope of a light breeze.
  double rms_slope(const PathHit& hit) const {
    return hit.surface == no_part ? 0.1 : surfaces_[hit.surface].rms_slope;
  }
  /// False if the facet approximates a curved surface: its vertex normals differ from its own normal.
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
  std::vector<Surface> surfaces_;        // by PathHit::surface
  std::optional<double> water_above_m_;  ///< height of the water surface over the sonar
  Mirror water_surface_;
};

}  // namespace sonard::render
