// SPDX-License-Identifier: Apache-2.0
// Pictures as file contents: PNG (libpng) and JPEG (libjpeg-turbo).
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace sonard::picture {

/// Encodes a PNG. A higher level takes longer and gives a smaller file: level 1 takes two thirds of the time
/// of level 3, for files a twentieth larger.
/// @param picture CV_8UC1, CV_8UC3 (BGR) or CV_8UC4 (BGRA), not empty
/// @param level of zlib, 1 to 9
/// @throws std::runtime_error if memory runs out, or a side exceeds 1,000,000 pixels
std::string png_file(const cv::Mat& picture, int level);

/// @param picture CV_8UC3 (BGR), not empty
/// @param quality 1 to 100
/// @throws std::runtime_error if memory runs out, or a side exceeds 65,500 pixels
std::string jpeg_file(const cv::Mat& picture, int quality);

}  // namespace sonard::picture
