// SPDX-License-Identifier: Apache-2.0
// Where a sonar looks, in words, and what it sees of the bed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/pose/posed_body.hpp"

namespace sonard::server {

/// "forward and 20 degrees down", "30 degrees to starboard, rolled by 90 degrees": the acoustic axis of a
/// mount, by the vehicle's axes.
std::string looks_text(const render::Pose& T_vehicle_sonar);

/// What is straight below a sonar, and the ranges at which it is in the beam.
struct BedView {
  std::string body;      ///< name of the nearest one below
  double below_m = 0.0;  ///< how far down it is
  /// Slant ranges of the first and the last point that its vertical beam (-3 dB) meets in the plane of the
  /// acoustic axis; nullopt: none is within the range of the ping. Surfaces steeper than 60 degrees are
  /// walls. Occlusion is ignored.
  std::optional<double> nearest_m, farthest_m;
};

/// nullopt: nothing is below the sonar.
/// @param moved bodies that are elsewhere than the world has them
/// @param without a body that is not looked at: the vehicle; may be empty
std::optional<BedView> view_of_bed(const render::World& world, const std::vector<PosedBody>& moved,
                                   const std::string& without, const render::Pose& T_world_sonar,
                                   const render::SonarSettings& settings);

/// "the bed below ('seabed') is seen from 6.1 to 40 m"
std::string bed_text(const std::optional<BedView>& view, double range_m);

}  // namespace sonard::server
