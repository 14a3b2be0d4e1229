// SPDX-License-Identifier: Apache-2.0
// How the ends of visible segments run across the wedge of their slice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderer/engines/cpu/visible_arrays.hpp"

namespace sonard::render {

/// Takes the runs of ends to what patches can say of them. One per thread; keeps its memory.
class VisibleEnds {
 public:
  /// Makes edge slopes those of straight lines across the wedge (EdgeRun::slope_within) that cross each other
  /// inside a surface only.
  ///
  /// Where two ends of a segment cross, it ends at a tip, beyond which straight ends leave it less than
  /// nothing. Inside a surface that does not matter: its neighbours have as much too much, at nearly the same
  /// range. At a silhouette, or where another body begins, they have it elsewhere, and lines are left without
  /// an echo. There the ends of the segments nearest to the silhouette meet at the side of the wedge instead,
  /// for which their inner ends turn with it: that moves a border inside a surface, so ranges change in
  /// second order only. No segment has another solid angle for it.
  void run_straight(float width_rad, float tan_limit, VisibleArrays& seen);

 private:
  void limit(float width_rad, float tan_limit, VisibleArrays& seen);
  void find_surfaces(const VisibleArrays& seen);
  static void keep_from_crossing(std::size_t first, std::size_t last, float width_rad, VisibleArrays& seen);

  std::vector<std::int32_t> goes_on_;  ///< whether each segment and the next one are of one surface
};

}  // namespace sonard::render
