// SPDX-License-Identifier: Apache-2.0
// The directions in which sound leaves and arrives: the fan as cells for the rays of multipath.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/aperture.hpp"

namespace sonard::render {

/// A patch of directions within one beam, in the sonar frame. Angles as in docs/physics.md 0.
struct FanCell {
  int beam = 0;
  double azimuth_rad = 0.0, elevation_rad = 0.0;  ///< of the middle
  double width_rad = 0.0, height_rad = 0.0;

  double solid_angle() const;
  glm::dvec3 direction() const;     ///< unit
  glm::dvec3 along_width() const;   ///< change of direction() from one side of the cell to the other
  glm::dvec3 along_height() const;  ///< change of direction() from the lower to the upper end
  /// One of columns x rows parts of the cell.
  FanCell part(int column, int row, int columns, int rows) const;
};

/// A grid of cells over the fan: columns divide beams; rows have equal elevation and are twice as high if
/// the elevation pattern is low.
class PathFan {
 public:
  /// @param coarseness factor of width and height of the cells
  explicit PathFan(const Aperture& aperture, double coarseness = 1.0);

  int columns() const { return static_cast<int>(columns_.size()); }
  int rows() const { return static_cast<int>(rows_.size()); }
  FanCell cell(int column, int row) const;
  /// FanCell::direction() of a cell.
  glm::dvec3 direction(int column, int row) const;
  /// Diagonal of the largest cell.
  double diagonal_rad() const { return diagonal_rad_; }

  /// The beam of an azimuth; nullopt outside the fan.
  std::optional<int> beam_of(double azimuth_rad) const;
  /// True if the sonar sends and receives in this direction, in the sonar frame.
  bool contains(const glm::dvec3& direction) const;
  const Aperture& aperture() const { return aperture_; }
  double coarseness() const { return coarseness_; }

 private:
  struct Column {
    int beam;
    double azimuth_rad, width_rad;
    double cosine, sine;  ///< of the azimuth
  };
  struct Row {
    double elevation_rad, height_rad;
    double cosine, sine;  ///< of the elevation
  };
  void add_rows(double from_rad, double to_rad, double highest_rad);

  Aperture aperture_;
  double coarseness_;
  std::vector<Column> columns_;
  std::vector<Row> rows_;
  double diagonal_rad_ = 0.0;
};

}  // namespace sonard::render
