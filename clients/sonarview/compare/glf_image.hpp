// SPDX-License-Identifier: Apache-2.0
// Images of a .glf log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace sonard::client {

/// An image of a .glf or .dat as a polar picture, CV_8UC1: a row for each line, near lines first, a column
/// for each beam.
/// @param number counts the images of the file from 0
/// @throws std::runtime_error naming the file: no such log, no such image, a damaged one
cv::Mat read_glf_image(const std::filesystem::path& file, std::uint64_t number);

}  // namespace sonard::client
