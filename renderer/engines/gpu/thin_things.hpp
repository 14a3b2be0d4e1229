// SPDX-License-Identifier: Apache-2.0
// What may be thinner than a column of samples, so that a grid might miss it: posts, bars, cables, stones.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// An island of a mesh, whose triangles share corners: the two of its corners that are far apart, and how far
/// the others lie from the straight line between them.
struct ThinThing {
  std::size_t body = 0;
  glm::dvec3 from_m, to_m;  ///< in the frame of the body
  double width_m = 0.0;     ///< from that of a round bar up to 1.5 times that of a square one
};

/// The thin things of a world: found by their triangles when the world is loaded, and placed for each ping.
class ThinThings {
 public:
  /// Looks at each island of each mesh that is at most half a metre wide. Left out are terrains, and meshes
  /// of more than 200,000 triangles.
  explicit ThinThings(const World& world);

  void set_body_pose(std::size_t body, const Pose& T_world_body);

  /// Columns that each beam needs, so that eight of them lie across each thin thing in it; 0: no thin thing
  /// is in the beam.
  /// @param range_m how far the sonar looks
  std::vector<int> least_columns(const Pose& T_world_sonar, const Aperture& aperture, double range_m) const;

  const std::vector<ThinThing>& all() const { return things_; }

 private:
  std::vector<ThinThing> things_;
  std::vector<Pose> T_world_body_;
};

/// Which posts and bars engine `gpu` may lose in single pings, since nobody looks for them: a sentence for
/// the user. Empty: none.
std::string thin_things_not_looked_for(const World& world, const SonarSettings& settings);

}  // namespace sonard::render
