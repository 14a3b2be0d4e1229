// SPDX-License-Identifier: Apache-2.0
// A picture of the ranges that a sonar measures in directions: as an image, and as points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace sonard::picture {

/// Ranges and signals by direction, [row * columns + column]. The axes of the outer directions lie on the
/// edges of the field of view. Column 0 is the port edge, row 0 the lowest.
struct DirectionImage {
  int columns = 0, rows = 0;  ///< >= 2
  double horizontal_fov_rad = 0.0, vertical_fov_rad = 0.0;
  double most_range_m = 0.0;         ///< > 0
  std::vector<float> range_m;        ///< 0: no echo
  std::vector<std::uint8_t> signal;  ///< 0: no echo
};

/// The point of an echo: x forward, y to starboard, z down, in metres.
cv::Point3f point_of(const DirectionImage& image, std::size_t pixel);

/// Ranges in colour, from near (red) to far (blue), above the signals; at the right the points from above and
/// from port. The highest row is at the top. CV_8UC3, BGR.
/// @param height_px of the picture, without the caption
cv::Mat draw(const DirectionImage& image, int height_px, const std::string& caption);

}  // namespace sonard::picture
