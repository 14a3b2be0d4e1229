// SPDX-License-Identifier: Apache-2.0
// Whether anything near the sonar is smooth enough to mirror sound: the numeric rule that spares all of
// multipath where it would not show.
#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/multipath/mirror_law.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Knows of every part that reflects at all the groups of facets it has, in the frame of the part: some
/// triangles that lie together, within one ball and with normals within one cone. Made once; asking costs a
/// few operations for each group that is in range, until one mirrors.
class MirrorSurvey {
 public:
  explicit MirrorSurvey(const World& world);

  /// A ball around a part, relative to the sonar and in world axes where nothing else is said.
  struct Ball {
    glm::dvec3 centre_m{0.0};
    double radius_m = 0.0;
  };
  /// Of a mesh, in its own frame.
  static Ball ball_around(const TriangleMesh& mesh);
  /// The parts in range that are seen under no more than this angle: rays of a grid may miss them.
  std::vector<Ball> small_parts(const World& world, const glm::dvec3& sonar_position_m, double range_m,
                                double angle_rad) const;

  /// Whether a surface of these bodies, no farther than `range_m`, could return a mirror image of more than
  /// least_mirror_gain to a sonar here: at the smallest grazing angle under which the sonar sees a point of
  /// it. Never false where one does.
  /// @param world the one it was made of, with its bodies where they are now.
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

/// Whether the water surface, a plane above the sonar, mirrors within range.
bool water_surface_mirrors(const Mirror& surface, double depth_m, double range_m, double wavelength_m);

}  // namespace sonard::render
