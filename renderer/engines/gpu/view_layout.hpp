// SPDX-License-Identifier: Apache-2.0
// Many views in one texture: changing textures costs a GPU more than a small view takes. They lie on their
// side: what bins a column has its samples one after the other in memory.
#pragma once

#include <vector>

#include "renderer/sample_grid/sample_grid.hpp"

namespace sonard::render {

/// Where the views of a grid lie in an array of textures of one size, in pixels: the sample of column c and
/// row r at (x + r, y + c). A function of the sizes of the views alone.
struct ViewLayout {
  struct Place {
    int x = 0, y = 0;  ///< of the lower left corner
    int layer = 0;
  };
  int width = 0, height = 0, layers = 0;
  std::vector<Place> places;  ///< of each view
};

/// @param most_px sides of a texture that OpenGL can have
/// @throws RequestError when a view is larger than that.
ViewLayout lay_out(const std::vector<SubView>& views, int most_px);

}  // namespace sonard::render
