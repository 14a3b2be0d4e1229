// SPDX-License-Identifier: Apache-2.0
// The elevations of a TIFF. libtiff reads it, and not GDAL: GDAL takes a text named .tif for a recipe, which
// may name other files and servers.
#pragma once

#include <filesystem>
#include <vector>

namespace sonard::render {

struct TiffElevations {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> value_m;  ///< row by row from the bottom; NaN: no elevation
};

/// The first channel of the first picture in the file: integers of 8 to 64 bits, reals of 16 to 64 bits, in
/// strips or tiles. Runs inside run_isolated().
/// @param most_px the longest side that is read
/// @throws std::runtime_error if the file is no TIFF, has other samples, or lacks a part that its directory
/// promises. Only blocks that a file with a NODATA value leaves out (sparse files of GDAL) are without
/// elevations.
TiffElevations read_tiff_elevations(const std::filesystem::path& file, int most_px);

}  // namespace sonard::render
