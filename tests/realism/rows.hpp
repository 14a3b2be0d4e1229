// SPDX-License-Identifier: Apache-2.0
// Compares laws of recorded images with our images (docs/physics.md 2.16).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace sonard::realism {

/// One law and its measurement, through the bytes of a head and its client, with the head's defaults.
struct Row {
  std::string_view head;
  std::string what;
  std::string_view recorded;  ///< value in recordings
  double least, most;         ///< tolerance for our value
  std::string_view unit;
  std::function<double()> measure;
};

/// Statistics of homogeneous patches: their middle and their bright third.
struct PatchRow {
  std::string_view head;
  std::string what;                                  ///< configuration and range
  std::function<std::array<double, 2>()> variation;  ///< standard deviation of the amplitude over its mean
  std::function<std::array<double, 2>()> index;      ///< variance of the intensity over its squared mean
};

inline constexpr double least_variation = 0.40, most_variation = 0.60;
inline constexpr double least_index = 1.0, most_index = 2.3;

std::vector<Row> gemini_noise_rows();
std::vector<Row> gemini_scene_rows();
std::vector<Row> micron_rows();
/// Homogeneous patches of the shipped worlds, from the first poses of their configurations.
std::vector<PatchRow> patch_rows();

}  // namespace sonard::realism
