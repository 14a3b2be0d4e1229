// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/view_layout.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

constexpr int step_px = 4;  // GPUs work on small squares of pixels, which views must not share

/// Views lie on their side.
int width_px(const SubView& view) {
  return view.rows;
}
int height_px(const SubView& view) {
  return view.columns;
}

int rounded_up(int px) {
  return (px + step_px - 1) / step_px * step_px;
}

}  // namespace

ViewLayout lay_out(const std::vector<SubView>& views, int most_px) {
  ViewLayout layout;
  double pixels = 0;
  for (const SubView& view : views) {
    if (view.columns > most_px || view.rows > most_px) {
      throw RequestError("sampling: a view exceeds the GL limit of " + std::to_string(most_px) + " pixels");
    }
    layout.width = std::max(layout.width, width_px(view));
    pixels += 1.0 * rounded_up(width_px(view)) * rounded_up(height_px(view));
  }
  layout.width = std::min(most_px, rounded_up(std::max(layout.width, static_cast<int>(std::sqrt(pixels)))));

  // Views are put on shelves, the highest first.
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return height_px(views[a]) > height_px(views[b]); });
  layout.places.resize(views.size());
  ViewLayout::Place next;
  int shelf_px = 0;
  for (const std::size_t v : order) {
    const SubView& view = views[v];
    if (next.x + width_px(view) > layout.width) {
      next = {0, next.y + rounded_up(shelf_px), next.layer};
      shelf_px = 0;
    }
    if (next.y + height_px(view) > most_px) {
      next = {0, 0, next.layer + 1};
    }
    shelf_px = std::max(shelf_px, height_px(view));
    layout.places[v] = next;
    layout.height = std::max(layout.height, next.y + height_px(view));
    layout.layers = next.layer + 1;
    next.x += rounded_up(width_px(view));
  }
  return layout;
}

}  // namespace sonard::render
