// SPDX-License-Identifier: Apache-2.0
// Lines of a scanning head as sonarview writes them with --raw.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace sonard::client {

/// The lines of one turn as a polar picture, CV_8UC1 (sweep_polar_image()); 4-bit lines 17 times as high.
/// @throws std::runtime_error naming the file: something that is no such line, lines of different steps or
/// numbers of bins in the turn, no line of the turn
cv::Mat read_sweep(const std::filesystem::path& file, std::uint64_t sweep);

}  // namespace sonard::client
