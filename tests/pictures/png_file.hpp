// SPDX-License-Identifier: Apache-2.0
// Pictures small enough for a repository.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace sonard::pictures {

/// Writes a picture (CV_8UC3, BGR) as a PNG with a palette of at most 256 colours: those of amber::palette()
/// in steps of 6, and those between background, grid and label. Speckle compresses to a third of what it
/// takes in full colour.
/// @throws std::runtime_error naming the file
void write_png(const std::filesystem::path& file, const cv::Mat& picture);

}  // namespace sonard::pictures
