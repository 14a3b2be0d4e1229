// SPDX-License-Identifier: Apache-2.0
// The directions of a sonar that measures the range in each of them, instead of an image of range bins.
#pragma once

#include <vector>

#include "renderer/aperture.hpp"

namespace sonard::render {

/// Beams at equal steps of azimuth and elevation, with Gaussian patterns. The middles of the outer beams lie
/// on the edges of the field of view. Angles in radians, in the sonar frame.
struct DirectionGrid {
  int columns = 0, rows = 0;                              ///< >= 2; 0: the sonar has no such beams
  double azimuth_fov_rad = 0.0, elevation_fov_rad = 0.0;  ///< > 0
  double azimuth_beamwidth_rad = 0.0, elevation_beamwidth_rad = 0.0;  ///< -3 dB full width, two-way; > 0
  double nearest_m = 0.0;                                             ///< nearer echoes do not count

  bool any() const { return columns > 0; }
  double column_step_rad() const { return azimuth_fov_rad / (columns - 1); }
  double row_step_rad() const { return elevation_fov_rad / (rows - 1); }
  /// Azimuth of a column, positive to port. Column 0 is the port edge.
  double azimuth_rad(int column) const { return azimuth_fov_rad / 2 - column * column_step_rad(); }
  /// Elevation of a row, positive up. Row 0 is the lowest.
  double elevation_rad(int row) const { return row * row_step_rad() - elevation_fov_rad / 2; }

  bool operator==(const DirectionGrid&) const = default;
};

/// Beams are rendered up to this angle on either side of their axes, where they are 19 dB down.
inline constexpr double direction_reach_beamwidths = 1.25;

/// The fan that these beams see: two rendered beams per column, of equal sensitivity over all elevations.
Aperture direction_aperture(const DirectionGrid& grid);

/// @throws RequestError if the grid or a beam is empty, not finite, or reaches beyond 80 degrees of the axis
void check_directions(const DirectionGrid& grid);

/// The strongest echo of each direction.
struct DirectionEchoes {
  int columns = 0, rows = 0;
  std::vector<float> range_m;    ///< [row * columns + column]; 0: no echo
  std::vector<float> intensity;  ///< re the source intensity at 1 m; 0: no echo
};

}  // namespace sonard::render
