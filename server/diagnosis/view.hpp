// SPDX-License-Identifier: Apache-2.0
// Describes a sonar's direction and its view of the bed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/aperture.hpp"
#include "renderer/scene/world.hpp"
#include "server/pose/posed_body.hpp"

namespace sonard::server {

/// Direction of the acoustic axis of a mount, in the vehicle's axes: "forward and 20 degrees down", "30
/// degrees to starboard, rolled by 90 degrees".
std::string looks_text(const render::Pose& T_vehicle_sonar);

/// The bed straight below a sonar, and its ranges in the beam.
struct BedView {
  std::string body;      ///< nearest body below
  double below_m = 0.0;  ///< depth below the sonar
  /// Slant ranges of the first and the last point that the vertical beam (-3 dB) meets in the plane of the
  /// acoustic axis; nullopt: no point is within the range of the ping. Surfaces steeper than 60 degrees count
  /// as walls. Occlusion is ignored.
  std::optional<double> nearest_m, farthest_m;
};

/// The view of the bed; nullopt if nothing is below the sonar.
/// @param moved current poses of bodies that have moved
/// @param without a body to ignore: the vehicle; may be empty
/// @param range_m of the ping
std::optional<BedView> view_of_bed(const render::World& world, const std::vector<PosedBody>& moved,
                                   const std::string& without, const render::Pose& T_world_sonar,
                                   const render::Aperture& aperture, double range_m);

/// "the bed below ('seabed') is visible from 6.1 to 40 m"
std::string bed_text(const std::optional<BedView>& view, double range_m);

}  // namespace sonard::server
