// SPDX-License-Identifier: Apache-2.0
// Many views in one texture, because changing textures takes a GPU longer than a small view. Views lie on
// their side, so that the samples of a column are contiguous in memory for binning.
#pragma once

#include <vector>

#include "renderer/sample_grid/sample_grid.hpp"

namespace sonard::render {

/// Places of the views of a grid in an array of textures of one size, in pixels: the sample of column c and
/// row r is at (x + r, y + c). They depend on the sizes of the views alone.
struct ViewLayout {
  struct Place {
    int x = 0, y = 0;  ///< of the lower left corner
    int layer = 0;
  };
  int width = 0, height = 0, layers = 0;
  std::vector<Place> places;  ///< one per view
};

/// @param most_px largest side of a texture in OpenGL
/// @throws RequestError if a view is larger
ViewLayout lay_out(const std::vector<SubView>& views, int most_px);

}  // namespace sonard::render
