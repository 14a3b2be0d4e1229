// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/map_placement.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

namespace sonard::render {

GeographicOrigin middle_of(const ElevationMap& map) {
  return map.georeference.value().place(0.5 * (map.picture.width_px - 1), 0.5 * (map.picture.height_px - 1));
}

MapPlacement place_map(const ElevationMap& map, const GeographicFrame& frame) {
  const double right = map.picture.width_px - 1, bottom = map.picture.height_px - 1;
  const auto at = [&](double column, double row) {
    const GeographicOrigin place = map.georeference.value().place(column, row);
    return frame.T_world_place(place.latitude_deg, place.longitude_deg, map.lowest_m).position_m;
  };
  const glm::dvec3 middle = at(0.5 * right, 0.5 * bottom);
  const glm::dvec3 along_rows = at(right, 0.5 * bottom) - at(0.0, 0.5 * bottom);
  const glm::dvec3 up_columns = at(0.5 * right, 0.0) - at(0.5 * right, bottom);
  const glm::dvec3 x = glm::normalize(along_rows);
  const glm::dvec3 z = glm::normalize(glm::cross(x, up_columns));
  MapPlacement placement{{middle, glm::normalize(glm::quat_cast(glm::dmat3(x, glm::cross(z, x), z)))},
                         {glm::length(along_rows), glm::length(up_columns), map.highest_m - map.lowest_m}};
  for (const double column : {0.0, 1.0}) {
    for (const double row : {0.0, 1.0}) {
      const glm::dvec3 corner((column - 0.5) * placement.size_m.x, (0.5 - row) * placement.size_m.y, 0.0);
      const glm::dvec3 here = middle + placement.T_world_map.orientation * corner;
      placement.corner_error_m =
          std::max(placement.corner_error_m, glm::length(here - at(column * right, row * bottom)));
    }
  }
  return placement;
}

std::string describe(const ElevationMap& map, const MapPlacement& placement) {
  const GeographicOrigin middle = middle_of(map);
  return fmt::format(
      "EPSG:{}, middle at {:.6f}, {:.6f}, {:.2f} x {:.2f} m, elevations {:.2f} to {:.2f} m above {}{}; "
      "corners are placed within {:.2g} m",
      map.georeference.value().crs, middle.latitude_deg, middle.longitude_deg, placement.size_m.x,
      placement.size_m.y, map.lowest_m, map.highest_m, map.georeference->vertical_datum(),
      map.holes_px > 0 ? fmt::format(", {} pixels without an elevation (holes)", map.holes_px) : "",
      placement.corner_error_m);
}

}  // namespace sonard::render
