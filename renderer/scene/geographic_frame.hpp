// SPDX-License-Identifier: Apache-2.0
// The position of a world on Earth.
#pragma once

#include <memory>

#include "renderer/pose.hpp"

namespace sonard::render {

/// The position of the world's (0, 0, 0), where x is east, y north, z up. WGS 84. Heights are above mean sea
/// level, as in MAVLink. Heights of other vertical datums are used without conversion, because the difference
/// depends on place and tide.
struct GeographicOrigin {
  double latitude_deg = 0.0;   ///< -90 to 90, north is positive
  double longitude_deg = 0.0;  ///< -180 to 180, east is positive
  double altitude_m = 0.0;

  bool operator==(const GeographicOrigin&) const = default;
};

/// Positions on Earth as poses in the world. The world's x-y plane touches the ellipsoid at the origin, so
/// the sea is 8 cm lower at a distance of 1 km. Uses GeographicLib::LocalCartesian. Several threads may read
/// it.
class GeographicFrame {
 public:
  /// @throws WorldError if sonard was built without GeographicLib
  explicit GeographicFrame(const GeographicOrigin& origin);

  /// Pose of the axes east, north and up at a position.
  Pose T_world_place(double latitude_deg, double longitude_deg, double altitude_m) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// Geographic coordinates of a position in a zone of UTM.
/// @throws WorldError if the numbers are not in the zone, or if sonard was built without GeographicLib
GeographicOrigin place_of_utm(int zone, bool northern, double easting_m, double northing_m);

}  // namespace sonard::render
