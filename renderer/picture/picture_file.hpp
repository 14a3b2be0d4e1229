// SPDX-License-Identifier: Apache-2.0
// Pictures as the bytes of a file: PNG (libpng) and JPEG (libjpeg-turbo).
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

namespace sonard::picture {

/// The smaller a PNG is to be, the longer it takes: 1, the quickest, takes two thirds of the time of 3 and
/// makes files a twentieth larger.
/// @param picture CV_8UC1, CV_8UC3 (BGR) or CV_8UC4 (BGRA), not empty
/// @param level of zlib, 1 to 9
/// @throws std::runtime_error without memory, or for a side beyond 1,000,000 pixels
std::string png_file(const cv::Mat& picture, int level);

/// @param picture CV_8UC3 (BGR), not empty
/// @param quality 1 to 100
/// @throws std::runtime_error without memory, or for a side beyond 65,500 pixels
std::string jpeg_file(const cv::Mat& picture, int quality);

/// What either kind of file shows, as BGR of 8 bits, without its transparency; 16 bits lose their lower half.
/// @return CV_8UC3; empty for anything but a whole picture of at most 2^28 pixels
cv::Mat from_picture_file(std::string_view bytes);

}  // namespace sonard::picture
