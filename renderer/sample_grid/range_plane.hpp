// SPDX-License-Identifier: Apache-2.0
// The range to the plane of a surface, as a function of the tangents of a view.
#pragma once

#include <cmath>

namespace sonard::render {

/// Range and its derivatives by the tangents (see SurfaceSample), metres.
struct RangePlane {
  float range, dx, dy;

  /// Moves from the ray at tangents (x, y) to the ray at (x + x_offset, y + y_offset). On a plane the inverse
  /// depth is affine in x and y, so the result is exact.
  void move(float x, float y, float x_offset, float y_offset) {
    const float qq = 1 + x * x + y * y;
    // Relative slopes of the inverse depth, from equation (2) of docs/physics.md 2.3.
    const float slope_x = x / qq - dx / range;
    const float slope_y = y / qq - dy / range;
    const float inverse_depth = 1 + slope_x * x_offset + slope_y * y_offset;
    if (inverse_depth < 0.5F) {
      return;  // the plane turns away within the pixel: keep the values of the pixel
    }
    const float to_x = x + x_offset;
    const float to_y = y + y_offset;
    const float to_qq = 1 + to_x * to_x + to_y * to_y;
    range *= std::sqrt(to_qq / qq) / inverse_depth;
    dx = range * (to_x / to_qq - slope_x / inverse_depth);
    dy = range * (to_y / to_qq - slope_y / inverse_depth);
  }
};

}  // namespace sonard::render
