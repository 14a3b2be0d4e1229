// SPDX-License-Identifier: Apache-2.0
// What a GeoTIFF says of its place (OGC GeoTIFF 1.1, OGC 19-008r4), and its holes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <glm/vec2.hpp>

#include "renderer/scene/geographic_frame.hpp"

namespace sonard::render {

/// Columns and rows of pixels count from the middle of the upper left one, to the right and down.
struct Georeference {
  int crs = 0;           ///< EPSG code of the horizontal system: geographic, or a zone of UTM
  int vertical_crs = 0;  ///< EPSG code; 0: not told
  glm::dvec2 first{};    ///< of the pixel (0, 0): longitude and latitude, or easting and northing
  glm::dvec2 step{};     ///< to the next column and row; the second is negative, for rows go south

  /// Its altitude is 0.
  /// @throws WorldError as place_of_utm()
  GeographicOrigin place(double column, double row) const;
  bool is_geographic() const;
  /// "EPSG:5773 (EGM96 height)"; "a datum that is not told".
  std::string vertical_datum() const;
};

struct GeoTiffTags {
  std::optional<double> no_data;  ///< the value of pixels without an elevation (GDAL_NODATA)
  std::optional<Georeference> georeference;
  std::string problem;  ///< why there is no georeference
};

/// Runs inside run_isolated(), too. Nothing is known of a file that is no TIFF.
GeoTiffTags read_geotiff_tags(const std::filesystem::path& file);

}  // namespace sonard::render
