// SPDX-License-Identifier: Apache-2.0
// Images whose measures are known.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace sonard::client {

/// CV_64FC1.
cv::Mat flat_image(int width, int height, double value);

/// +-`contrast` about 128 from pixel to pixel.
cv::Mat checkerboard(int width, int height, double contrast);

/// Random blobs of some five pixels, 0..255. The same for the same seed.
cv::Mat random_texture(int width, int height, std::uint64_t seed);

}  // namespace sonard::client
