// SPDX-License-Identifier: Apache-2.0
// Pictures of one turn of a scanning sonar.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "renderer/picture/fan_image.hpp"
#include "renderer/picture/sector_geometry.hpp"

namespace sonard::picture {

/// Bearings are whole units of 1/16 gradian, as in scanning sonars: 6400 per turn, 3200 ahead, rising
/// clockwise.
inline constexpr int units_per_turn = 6400;

/// The nearest bearing to an angle, modulo 2 pi; 0 is ahead, positive to starboard: 0..6399.
int turn_bearing(double bearing_rad);
/// An angle in units, at least 1.
int turn_units(double angle_rad);

/// The sector and range of one turn, in units_per_turn and bins.
struct SweepShape {
  int left = 0;        ///< start of the sector, 0..6399
  int width = 6400;    ///< clockwise from `left` to the last bearing, > 0; 6400: full circle
  int step = 32;       ///< between lines, 1..255
  int bins = 0;        ///< > 0
  double bin_m = 0.0;  ///< bin k covers [k, k + 1) * bin_m; > 0

  bool full_circle() const { return width + step >= 6400; }
  double range_m() const { return bins * bin_m; }
};

struct SweepLine {
  int bearing = 0;                    ///< 0..6399
  std::vector<std::uint8_t> samples;  ///< SweepShape::bins samples, near to far
};

/// Draws turns of one shape; the map from pixel to sample is computed once. Any thread, one at a time.
///
/// Each line fills its own step, from half a step before its bearing to half a step after it. If lines
/// overlap, the later one is visible. Nothing is interpolated between lines: gaps show the background.
class SweepImage {
 public:
  SweepImage(const SweepShape& shape, const FanStyle& style);

  const SectorGeometry& geometry() const { return geometry_; }

  struct Projection {
    cv::Mat samples;  ///< CV_8UC1 of geometry().size(); smooth: linear between bins; 0: no samples
    cv::Mat covered;  ///< CV_8UC1, 255 if there are samples
  };
  Projection project(const std::vector<SweepLine>& lines, Resampling resampling = Resampling::smooth) const;

  /// project() in colour (CV_8UC3, BGR), with the grid, and `caption` in the top left corner.
  cv::Mat draw(const std::vector<SweepLine>& lines, const std::string& caption) const;

 private:
  void map_pixels();

  SweepShape shape_;
  SectorGeometry geometry_;
  FanStyle style_;
  int mapped_bins_;   ///< bins of the image that the map refers to
  cv::Mat map_bins_;  ///< CV_32FC1: fractional bin of each pixel
  cv::Mat slots_;     ///< CV_32SC1: bearing of each pixel, in half units; -1 outside
  cv::Mat grid_;      ///< CV_8UC3, black if not drawn
};

/// The raw samples of a turn, CV_8UC1: one column per step, clockwise from SweepShape::left (full circle:
/// from astern, so that ahead is in the middle); one row per bin, range upwards. A line is in the column
/// nearest to its bearing; a column without a line is 0.
cv::Mat sweep_polar_image(const SweepShape& shape, const std::vector<SweepLine>& lines);

}  // namespace sonard::picture
