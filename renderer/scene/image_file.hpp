// SPDX-License-Identifier: Apache-2.0
// Images of worlds: height maps and normal maps. Local PNG, JPEG, BMP, TGA or PNM files, through osgDB, and
// TIFF files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "renderer/scene/geotiff.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Row 0 is the bottom row of the picture.
struct GreyImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint16_t> value;  ///< 0 to 65535; 8-bit files use the whole range
  std::vector<bool> hole{};          ///< pixels without a value; empty: no holes

  bool is_hole(std::size_t pixel) const { return !hole.empty() && hole[pixel]; }
  bool is_hole(int x, int y) const {
    return is_hole(static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                   static_cast<std::size_t>(x));
  }
};

/// A map of elevations: a TIFF of integers or reals.
struct ElevationMap {
  GreyImage picture;  ///< the lowest elevation is 0, the highest 65535
  double lowest_m = 0.0;
  double highest_m = 0.0;
  std::size_t holes_px = 0;
  std::optional<Georeference> georeference;
  std::string no_georeference_because;
};

/// Loads the first channel of an 8 or 16-bit image.
/// @throws WorldError with the file name if the file is missing, damaged or of another kind.
GreyImage load_grey_image(const std::filesystem::path& file);

bool is_elevation_map(const std::filesystem::path& file);

/// @throws WorldError with the file name
ElevationMap load_elevation_map(const std::filesystem::path& file);

/// Loads a tangent-space normal map from an 8 or 16-bit RGB image.
/// @throws WorldError with the file name.
NormalMap load_normal_map(const std::filesystem::path& file);

}  // namespace sonard::render
