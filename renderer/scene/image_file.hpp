// SPDX-License-Identifier: Apache-2.0
// Images of worlds: height maps and normal maps. Local PNG, JPEG, TIFF, BMP, TGA or PNM files, through osgDB.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Row 0 is the bottom row of the picture.
struct GreyImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint16_t> value;  ///< 0 to 65535; 8-bit files are spread over the whole range
};

/// The first channel of an 8 or 16-bit image; of a TIFF, also a GeoTIFF of any sample format, the elevations
/// from the lowest, 0, to the highest, 65535.
/// @throws WorldError naming the file when it is missing, damaged or of another kind.
GreyImage load_grey_image(const std::filesystem::path& file);

/// A tangent-space normal map from an 8 or 16-bit RGB image.
/// @throws WorldError naming the file.
NormalMap load_normal_map(const std::filesystem::path& file);

}  // namespace sonard::render
