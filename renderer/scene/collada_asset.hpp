// SPDX-License-Identifier: Apache-2.0
// Properties of a COLLADA document as a whole.
#pragma once

#include <filesystem>
#include <string>

namespace sonard::render {

struct ColladaAsset {
  double unit_m = 1.0;  ///< metres per unit of the file, > 0
  std::string up_axis;  ///< "X_UP", "Y_UP" or "Z_UP"; empty: not given
};

/// Reads the document's own <asset>. An <asset> of a library does not count.
/// @throws WorldError without the file's name if the unit is not a number above 0.
ColladaAsset read_collada_asset(const std::filesystem::path& file);

}  // namespace sonard::render
