// SPDX-License-Identifier: Apache-2.0
// Where a world is on Earth.
#pragma once

#include <memory>

#include "renderer/pose.hpp"

namespace sonard::render {

/// The place of the world's (0, 0, 0): x is east, y north, z up there. WGS 84. Heights are above mean sea
/// level, as MAVLink's are; heights of other vertical datums are subtracted as they are, for what lies
/// between two depends on the place and the tide.
struct GeographicOrigin {
  double latitude_deg = 0.0;   ///< -90 to 90, north is positive
  double longitude_deg = 0.0;  ///< -180 to 180, east is positive
  double altitude_m = 0.0;

  bool operator==(const GeographicOrigin&) const = default;
};

/// Places on Earth as poses in the world: a plane that touches the ellipsoid in the origin, so that the sea
/// is 8 cm lower at a distance of 1 km. By GeographicLib::LocalCartesian. Reading it from several threads is
/// safe.
class GeographicFrame {
 public:
  /// @throws WorldError where sonard was built without GeographicLib
  explicit GeographicFrame(const GeographicOrigin& origin);

  /// Of the axes east, north and up of a place.
  Pose T_world_place(double latitude_deg, double longitude_deg, double altitude_m) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// Geographic coordinates of a place in a zone of UTM.
/// @throws WorldError where the numbers are no place of the zone, and as GeographicFrame does
GeographicOrigin place_of_utm(int zone, bool northern, double easting_m, double northing_m);

}  // namespace sonard::render
