// SPDX-License-Identifier: Apache-2.0
// Compares laws of recorded images with our images (docs/physics.md 2.16).
#pragma once

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

std::vector<Row> gemini_noise_rows();
std::vector<Row> gemini_scene_rows();
std::vector<Row> micron_rows();
/// Homogeneous patches of the shipped worlds, from the first poses of their configurations.
std::vector<Row> patch_rows();

}  // namespace sonard::realism
