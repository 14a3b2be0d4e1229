// SPDX-License-Identifier: Apache-2.0
// Reads lines of a scanning head from a file of `sonarview --raw`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace sonard::client {

/// Reads the lines of one turn as a polar picture, CV_8UC1 (sweep_polar_image()); 4-bit samples are
/// multiplied by 17.
/// @throws std::runtime_error that names the file: not such a line, lines of different steps or numbers of
/// bins in the turn, no line of the turn
cv::Mat read_sweep(const std::filesystem::path& file, std::uint64_t sweep);

}  // namespace sonard::client
