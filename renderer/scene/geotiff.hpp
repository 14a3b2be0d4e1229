// SPDX-License-Identifier: Apache-2.0
// The georeference of a GeoTIFF (OGC GeoTIFF 1.1, OGC 19-008r4), and its value for holes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <glm/vec2.hpp>

#include "renderer/scene/geographic_frame.hpp"

namespace sonard::render {

/// Columns and rows count from the middle of the upper left pixel, to the right and down.
struct Georeference {
  int crs = 0;           ///< EPSG code of the horizontal system: geographic, or a zone of UTM
  int vertical_crs = 0;  ///< EPSG code; 0: not given
  glm::dvec2 first{};    ///< of the pixel (0, 0): longitude and latitude, or easting and northing
  glm::dvec2 step{};     ///< to the next column and row; the second is negative, because rows go south

  /// Geographic coordinates of a pixel, at altitude 0.
  /// @throws WorldError as place_of_utm()
  GeographicOrigin place(double column, double row) const;
  bool is_geographic() const;
  /// "EPSG:5773 (EGM96 height)", or a phrase if the file does not give the datum.
  std::string vertical_datum() const;
};

struct GeoTiffTags {
  std::optional<double> no_data;  ///< the value of pixels without an elevation (GDAL_NODATA)
  std::optional<Georeference> georeference;
  std::string problem;  ///< the reason if there is no georeference
};

/// Reads the tags, empty if the file is not a TIFF. Also safe inside run_isolated().
GeoTiffTags read_geotiff_tags(const std::filesystem::path& file);

}  // namespace sonard::render
