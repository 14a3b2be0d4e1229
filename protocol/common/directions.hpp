// SPDX-License-Identifier: Apache-2.0
// Pings of heads that measure the range of the strongest echo in each of many directions, instead of an image
// of range bins.
#pragma once

#include <cstddef>
#include <vector>

namespace sonard {

/// Directions of a ping: beams at equal steps of both angles about the head's x axis. The axes of the outer
/// beams lie on the edges of the field of view. Column 0 is the port edge, row 0 the lowest.
struct Directions {
  int columns = 0, rows = 0;                                ///< >= 2; 0: the head has no such beams
  double horizontal_fov_rad = 0.0, vertical_fov_rad = 0.0;  ///< > 0
  double nearest_m = 0.0;                                   ///< nearer echoes do not count

  bool any() const { return columns > 0; }
  std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }

  bool operator==(const Directions&) const = default;
};

/// The strongest echo of each direction, [row * columns + column], without noise or threshold.
struct DirectionRanges {
  int columns = 0, rows = 0;     ///< 0: the ping has an image instead
  std::vector<float> range_m;    ///< along the direction, at the true sound speed; 0: no echo
  std::vector<float> intensity;  ///< re the source intensity at 1 m; 0: no echo

  bool operator==(const DirectionRanges&) const = default;
};

}  // namespace sonard
