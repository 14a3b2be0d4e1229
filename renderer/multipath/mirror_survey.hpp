// SPDX-License-Identifier: Apache-2.0
// Tests whether anything near the sonar is smooth enough to mirror sound: the numeric rule that skips
// multipath if it has no visible effect.
#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/multipath/mirror_law.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Holds the groups of facets of every reflecting part, in the frame of the part. A group is a few adjacent
/// triangles within one ball, with normals within one cone. It is made once; a query costs a few operations
/// per group in range, until one mirrors.
class MirrorSurvey {
 public:
  explicit MirrorSurvey(const World& world);

  /// A ball around a part, relative to the sonar and in world axes unless stated otherwise.
  struct Ball {
    glm::dvec3 centre_m{0.0};
    double radius_m = 0.0;
  };
  /// A ball around a mesh, in the frame of the mesh.
  static Ball ball_around(const TriangleMesh& mesh);
  /// The parts in range that subtend at most `angle_rad`: a grid of rays may miss them.
  std::vector<Ball> small_parts(const World& world, const glm::dvec3& sonar_position_m, double range_m,
                                double angle_rad) const;

  /// True if a surface of these bodies within `range_m` could mirror sound with more than least_mirror_gain,
  /// at the smallest grazing angle under which the sonar sees a point of it. Never false if one does.
  /// @param world the world given to the constructor, with current poses of its bodies
  bool has_mirror(const World& world, const glm::dvec3& sonar_position_m, double range_m,
                  double wavelength_m) const;

 private:
  struct Group {
    glm::dvec3 centre_m{0.0};
    double radius_m = 0.0;
    glm::dvec3 normal{0.0, 0.0, 1.0};  ///< axis of the cone
    double half_angle_rad = 0.0;       ///< of the cone; pi / 2 and more: any grazing angle
  };
  struct Part {
    std::size_t body = 0, part = 0;
    Mirror mirror;
    Ball ball;  ///< in the frame of the part
    std::vector<Group> groups;
  };

  static std::vector<Group> groups_of(const TriangleMesh& mesh);
  static Group group_of(const TriangleMesh& mesh, std::size_t first, std::size_t end);

  std::vector<Part> parts_;
};

/// True if the water surface, a plane above the sonar, mirrors within range.
bool water_surface_mirrors(const Mirror& surface, double depth_m, double range_m, double wavelength_m);

}  // namespace sonard::render
