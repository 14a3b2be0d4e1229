// SPDX-License-Identifier: Apache-2.0
// Writes pictures that are small enough for a repository.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace sonard::pictures {

/// Writes a picture (CV_8UC3, BGR) as a PNG with a palette of at most 256 colours: every sixth colour of
/// amber::palette(), and mixtures of background, grid and label colours. Speckle compresses to a third of its
/// size in full colour.
/// @throws std::runtime_error that names the file
void write_png(const std::filesystem::path& file, const cv::Mat& picture);

}  // namespace sonard::pictures
