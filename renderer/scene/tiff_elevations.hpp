// SPDX-License-Identifier: Apache-2.0
// Reads the elevations of a TIFF by libtiff. GDAL is not used, because it interprets a text named .tif as a
// recipe, which may name other files and servers.
#pragma once

#include <filesystem>
#include <vector>

namespace sonard::render {

struct TiffElevations {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> value_m;  ///< row by row from the bottom; NaN: no elevation
};

/// Reads the first channel of the first picture in the file: integers of 8 to 64 bits or reals of 16 to 64
/// bits, in strips or tiles. Runs inside run_isolated().
/// @param most_px limit for the longest side
/// @throws std::runtime_error if the file is not a TIFF, has other samples, or lacks a part listed in its
/// directory. Only blocks left out of a file with a NODATA value (GDAL's sparse files) have no elevations.
TiffElevations read_tiff_elevations(const std::filesystem::path& file, int most_px);

}  // namespace sonard::render
