// SPDX-License-Identifier: Apache-2.0
#include "renderer/direction_grid.hpp"

#include <cmath>
#include <numbers>

#include "renderer/errors.hpp"

namespace sonard::render {
namespace {

constexpr double widest_rad = 80 * std::numbers::pi / 180;
constexpr int most_columns = 1024, most_rows = 1024;

/// Half of the angles that the beams see.
double half_width_rad(double fov_rad, double beamwidth_rad) {
  return fov_rad / 2 + direction_reach_beamwidths * beamwidth_rad;
}

bool is_usable(double fov_rad, double beamwidth_rad) {
  return fov_rad > 0 && beamwidth_rad > 0 && half_width_rad(fov_rad, beamwidth_rad) <= widest_rad;
}

}  // namespace

Aperture direction_aperture(const DirectionGrid& grid) {
  const double half_rad = half_width_rad(grid.azimuth_fov_rad, grid.azimuth_beamwidth_rad);
  Aperture aperture;
  aperture.beam_edges_rad =
      equal_angle_edges(static_cast<int>(std::ceil(4 * half_rad / grid.column_step_rad())), 2 * half_rad);
  aperture.elevation = Aperture::Elevation::top_hat;
  aperture.vertical_beamwidth_rad = 2 * half_width_rad(grid.elevation_fov_rad, grid.elevation_beamwidth_rad);
  aperture.receive_beamwidth_rad = grid.azimuth_beamwidth_rad;
  return aperture;
}

void check_directions(const DirectionGrid& grid) {
  if (grid.columns < 2 || grid.columns > most_columns || grid.rows < 2 || grid.rows > most_rows) {
    throw RequestError("directions: " + std::to_string(grid.columns) + " x " + std::to_string(grid.rows) +
                       ", expected 2 to " + std::to_string(most_columns) + " columns and 2 to " +
                       std::to_string(most_rows) + " rows");
  }
  if (!is_usable(grid.azimuth_fov_rad, grid.azimuth_beamwidth_rad) ||
      !is_usable(grid.elevation_fov_rad, grid.elevation_beamwidth_rad)) {
    throw RequestError(
        "directions: the beams must see angles of more than 0 and up to 80 degrees of the axis");
  }
  if (!(grid.nearest_m >= 0)) {
    throw RequestError("directions: the nearest range is negative");
  }
}

}  // namespace sonard::render
