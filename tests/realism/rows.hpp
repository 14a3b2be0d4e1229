// SPDX-License-Identifier: Apache-2.0
// How real the images are: laws of recorded images, and how far ours follow them (docs/physics.md 2.16).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace sonard::realism {

/// One law, and how it is measured: through the bytes of a head and its client, with the defaults of that
/// head.
struct Row {
  std::string_view head;
  std::string what;
  std::string_view recorded;  ///< as the recordings have it
  double least, most;         ///< tolerance of ours
  std::string_view unit;
  std::function<double()> measure;
};

std::vector<Row> gemini_noise_rows();
std::vector<Row> gemini_scene_rows();
std::vector<Row> micron_rows();
/// Homogeneous patches of the shipped worlds, seen from where their configurations begin.
std::vector<Row> patch_rows();

}  // namespace sonard::realism
