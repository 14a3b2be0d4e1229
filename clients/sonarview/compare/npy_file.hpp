// SPDX-License-Identifier: Apache-2.0
// Arrays in NumPy's file format, as sonard's `dump` writes them.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace sonard::client {

/// Reads a table of unsigned samples of 8 or 16 bits (|u1, <u2) in C order, rows first.
/// @return CV_8UC1 or CV_16UC1
/// @throws std::runtime_error naming the file, for any other array and for one that is cut short
cv::Mat read_npy(const std::filesystem::path& file);

}  // namespace sonard::client
