// SPDX-License-Identifier: Apache-2.0
// What a COLLADA file says of itself as a whole.
#pragma once

#include <filesystem>
#include <string>

namespace sonard::render {

struct ColladaAsset {
  double unit_m = 1.0;  ///< metres per unit of the file, > 0
  std::string up_axis;  ///< "X_UP", "Y_UP" or "Z_UP"; empty: not said
};

/// The document's own <asset>. Those of its libraries do not count.
/// @throws WorldError without the file's name when the unit is no number above 0.
ColladaAsset read_collada_asset(const std::filesystem::path& file);

}  // namespace sonard::render
