// SPDX-License-Identifier: Apache-2.0
// Edges of visible segments across the wedge of their slice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderer/engines/cpu/visible_arrays.hpp"

namespace sonard::render {

/// Limits the runs of ends to runs that patches can represent. One per thread; reuses its memory.
class VisibleEnds {
 public:
  /// Replaces edge slopes by slopes of straight lines across the wedge (slices::slope_within()) that cross
  /// each other only inside a surface.
  ///
  /// If the two ends of a segment cross, it ends at a tip, and beyond the tip straight ends make it negative.
  /// Inside a surface that is harmless: its neighbours are too large by as much, at nearly the same range. At
  /// a silhouette, or at the border to another body, they are at other ranges, and lines are left without an
  /// echo. There the ends of the segments nearest to the silhouette meet at the side of the wedge instead,
  /// and their inner ends turn too. That moves a border inside a surface, so ranges change in second order
  /// only. Solid angles stay the same.
  void run_straight(float width_rad, float tan_limit, VisibleArrays& seen);

 private:
  void limit(float width_rad, float tan_limit, VisibleArrays& seen);
  void find_surfaces(const VisibleArrays& seen);
  static void keep_from_crossing(std::size_t first, std::size_t last, float width_rad, VisibleArrays& seen);

  std::vector<std::int32_t> goes_on_;  ///< 1 if a segment and the next one belong to one surface
};

}  // namespace sonard::render
