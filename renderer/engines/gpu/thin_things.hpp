// SPDX-License-Identifier: Apache-2.0
// Things thinner than a column of samples, which a grid may miss: posts, bars, cables, stones.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// An island of a mesh, whose triangles share corners: two corners that are far apart, and the largest
/// distance of the others from the straight line between them.
struct ThinThing {
  std::size_t body = 0;
  glm::dvec3 from_m, to_m;  ///< in the frame of the body
  double width_m = 0.0;     ///< 1 (round bar) to 1.5 (square bar) times the width of the bar
};

/// The thin things of a world: found in the meshes when the world is loaded, and placed for each ping.
class ThinThings {
 public:
  /// Finds all islands of meshes that are at most half a metre wide, without terrains and meshes of more than
  /// 200,000 triangles.
  explicit ThinThings(const World& world);

  void set_body_pose(std::size_t body, const Pose& T_world_body);

  /// Columns that each beam needs so that eight lie across each thin thing in it; 0 if the beam has no thin
  /// thing.
  /// @param range_m range of the sonar
  std::vector<int> least_columns(const Pose& T_world_sonar, const Aperture& aperture, double range_m) const;

  const std::vector<ThinThing>& all() const { return things_; }

 private:
  std::vector<ThinThing> things_;
  std::vector<Pose> T_world_body_;
};

/// A sentence for the user about posts and bars that engine `gpu` may miss in some pings, because thin things
/// are not searched for there; empty if there are no such limits.
std::string thin_things_not_looked_for(const World& world, const SonarSettings& settings);

}  // namespace sonard::render
