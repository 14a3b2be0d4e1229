// SPDX-License-Identifier: Apache-2.0
// Images with known measures.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace sonard::client {

/// An image of one value, CV_64FC1.
cv::Mat flat_image(int width, int height, double value);

/// 128 plus and minus `contrast`, alternating from pixel to pixel.
cv::Mat checkerboard(int width, int height, double contrast);

/// Random blobs of about five pixels, 0..255. Equal seeds give equal images.
cv::Mat random_texture(int width, int height, std::uint64_t seed);

}  // namespace sonard::client
