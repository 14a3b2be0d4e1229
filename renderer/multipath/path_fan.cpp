// SPDX-License-Identifier: Apache-2.0
#include "renderer/multipath/path_fan.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace sonard::render {

namespace {
constexpr double degree = std::numbers::pi / 180.0;
constexpr double widest_column_rad = 0.25 * degree;
constexpr double highest_row_rad = 0.16 * degree;
constexpr double low_weight = 0.25;  // of the elevation pattern

/// Elevation at which the pattern has fallen to low_weight, at most the end of the fan.
double well_ensonified_rad(const Aperture& aperture) {
  double ensonified = 0.0;
  double end = aperture.elevation_limit_rad();
  if (aperture.elevation_weight(end) >= low_weight) {
    return end;
  }
  while (end - ensonified > highest_row_rad) {
    const double middle = 0.5 * (ensonified + end);
    (aperture.elevation_weight(middle) >= low_weight ? ensonified : end) = middle;
  }
  return ensonified;
}
}  // namespace

double FanCell::solid_angle() const {
  return width_rad *
         (std::sin(elevation_rad + 0.5 * height_rad) - std::sin(elevation_rad - 0.5 * height_rad));
}

glm::dvec3 FanCell::direction() const {
  const double level = std::cos(elevation_rad);
  return {level * std::cos(azimuth_rad), level * std::sin(azimuth_rad), std::sin(elevation_rad)};
}

glm::dvec3 FanCell::along_width() const {
  const double level = width_rad * std::cos(elevation_rad);
  return {-level * std::sin(azimuth_rad), level * std::cos(azimuth_rad), 0.0};
}

glm::dvec3 FanCell::along_height() const {
  const double upright = height_rad * std::sin(elevation_rad);
  return {-upright * std::cos(azimuth_rad), -upright * std::sin(azimuth_rad),
          height_rad * std::cos(elevation_rad)};
}

FanCell FanCell::part(int column, int row, int columns, int rows) const {
  return {beam, azimuth_rad + width_rad * ((column + 0.5) / columns - 0.5),
          elevation_rad + height_rad * ((row + 0.5) / rows - 0.5), width_rad / columns, height_rad / rows};
}

PathFan::PathFan(const Aperture& aperture, double coarseness) : aperture_(aperture), coarseness_(coarseness) {
  double widest = 0.0;
  for (int beam = 0; beam < aperture.beam_count(); ++beam) {
    const double from = aperture.beam_edges_rad[static_cast<std::size_t>(beam)];
    const double width = from - aperture.beam_edges_rad[static_cast<std::size_t>(beam) + 1];
    const int columns =
        std::max(1, static_cast<int>(std::ceil(width / (coarseness * widest_column_rad) - 1e-6)));
    for (int i = 0; i < columns; ++i) {
      const double azimuth_rad = from - width * (i + 0.5) / columns;
      columns_.push_back({beam, azimuth_rad, width / columns, std::cos(azimuth_rad), std::sin(azimuth_rad)});
      widest = std::max(widest, width / columns);
    }
  }
  const double limit = aperture.elevation_limit_rad();
  const double ensonified = well_ensonified_rad(aperture);
  const double highest = coarseness * highest_row_rad;
  add_rows(-limit, -ensonified, 2 * highest);
  add_rows(-ensonified, ensonified, highest);
  add_rows(ensonified, limit, 2 * highest);
  for (const Row& row : rows_) {
    diagonal_rad_ = std::max(diagonal_rad_, std::hypot(widest, row.height_rad));
  }
}

void PathFan::add_rows(double from_rad, double to_rad, double highest_rad) {
  const int rows = static_cast<int>(std::ceil((to_rad - from_rad) / highest_rad - 1e-6));
  for (int i = 0; i < rows; ++i) {
    const double height = (to_rad - from_rad) / rows;
    const double elevation_rad = from_rad + (i + 0.5) * height;
    rows_.push_back({elevation_rad, height, std::cos(elevation_rad), std::sin(elevation_rad)});
  }
}

FanCell PathFan::cell(int column, int row) const {
  const Column& at = columns_[static_cast<std::size_t>(column)];
  const Row& level = rows_[static_cast<std::size_t>(row)];
  return {at.beam, at.azimuth_rad, level.elevation_rad, at.width_rad, level.height_rad};
}

glm::dvec3 PathFan::direction(int column, int row) const {
  const Column& at = columns_[static_cast<std::size_t>(column)];
  const Row& level = rows_[static_cast<std::size_t>(row)];
  return {level.cosine * at.cosine, level.cosine * at.sine, level.sine};
}

std::optional<int> PathFan::beam_of(double azimuth_rad) const {
  const auto& edges = aperture_.beam_edges_rad;  // falling
  const auto after = std::lower_bound(edges.begin(), edges.end(), azimuth_rad, std::greater<>());
  if (after == edges.end() || (after == edges.begin() && *after != azimuth_rad)) {
    return std::nullopt;
  }
  return std::max(0, static_cast<int>(after - edges.begin()) - 1);
}

bool PathFan::contains(const glm::dvec3& direction) const {
  const double elevation_rad = std::atan2(direction.z, std::hypot(direction.x, direction.y));
  return std::abs(elevation_rad) <= aperture_.elevation_limit_rad() &&
         beam_of(std::atan2(direction.y, direction.x)).has_value();
}

}  // namespace sonard::render
