// SPDX-License-Identifier: Apache-2.0
// The position of a georeferenced map in the world.
#pragma once

#include <string>

#include <glm/vec3.hpp>

#include "renderer/scene/geographic_frame.hpp"
#include "renderer/scene/image_file.hpp"

namespace sonard::render {

struct MapPlacement {
  Pose T_world_map;   ///< the map's middle at the lowest elevation; x along its rows, y up its columns
  glm::dvec3 size_m;  ///< from corner pixel to corner pixel, and from the lowest elevation to the highest
  double corner_error_m = 0.0;  ///< largest position error of a corner: the map stays a flat rectangle
};

/// @param map must have a georeference
/// @throws WorldError if its corners are not positions on Earth
MapPlacement place_map(const ElevationMap& map, const GeographicFrame& frame);

/// The position of the map's middle, at altitude 0.
GeographicOrigin middle_of(const ElevationMap& map);

/// "EPSG:32632, 400.00 x 300.00 m, elevations -31.50 to -26.50 m above EPSG:5773 (EGM96 height), ...".
std::string describe(const ElevationMap& map, const MapPlacement& placement);

}  // namespace sonard::render
