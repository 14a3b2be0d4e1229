// SPDX-License-Identifier: Apache-2.0
// How the ends of visible pieces run across the wedge of their slice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderer/engines/cpu/piece_arrays.hpp"

namespace sonard::render {

/// Takes the runs of ends to what patches can say of them. One per thread; keeps its memory.
class PieceEnds {
 public:
  /// Drifts become those of straight lines across the wedge (EdgeRun::drift_within), and cross none but
  /// inside a surface.
  ///
  /// Where two ends of a piece cross, it ends at a tip, beyond which straight ends leave it less than
  /// nothing. Inside a surface that is as well: its neighbours have as much too much, at nearly the same
  /// range. At a silhouette, or where another body begins, they have it elsewhere, and lines are left without
  /// an echo. There the ends of the pieces nearest to the silhouette meet at the side of the wedge instead,
  /// for which their inner ends turn with it: that moves a border inside a surface, so ranges change in
  /// second order only. No piece has another solid angle for it.
  /// @param pieces what `seen` was laid out from.
  void run_straight(const std::vector<VisiblePiece>& pieces, float width_rad, float tan_limit,
                    PieceArrays& seen);

 private:
  void limit(float width_rad, float tan_limit, PieceArrays& seen);
  void find_surfaces(const std::vector<VisiblePiece>& pieces, const PieceArrays& seen);
  static void keep_apart(std::size_t first, std::size_t last, float width_rad, PieceArrays& seen);

  std::vector<std::uint32_t> part_;
  std::vector<std::int32_t> goes_on_;  ///< whether each piece and the next one are of one surface
};

}  // namespace sonard::render
