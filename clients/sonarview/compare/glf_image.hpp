// SPDX-License-Identifier: Apache-2.0
// Images of a .glf log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace sonard::client {

/// Reads an image of a .glf or .dat as a polar picture, CV_8UC1: a row for each line, near lines first, a
/// column for each beam.
/// @param number counts the images of the file from 0
/// @throws std::runtime_error that names the file: not such a log, no such image, a damaged image
cv::Mat read_glf_image(const std::filesystem::path& file, std::uint64_t number);

}  // namespace sonard::client
