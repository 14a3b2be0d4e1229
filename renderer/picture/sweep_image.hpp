// SPDX-License-Identifier: Apache-2.0
// Pictures of one turn of a scanning head.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "renderer/picture/fan_image.hpp"
#include "renderer/picture/sector_geometry.hpp"

namespace sonard::picture {

/// Bearings of turns are whole units of 1/16 gradian, as scanning heads count them: 6400 to the turn, 3200
/// ahead, rising clockwise.
inline constexpr int units_per_turn = 6400;

/// The bearing nearest to an angle of any number of turns, 0 ahead, positive to starboard: 0..6399.
int turn_bearing(double bearing_rad);
/// An angle as units, at least 1.
int turn_units(double angle_rad);

/// What one turn covers, in units_per_turn and bins.
struct SweepShape {
  int left = 0;        ///< where the sector begins, 0..6399
  int width = 6400;    ///< from there clockwise to its last bearing, > 0; 6400: all round
  int step = 32;       ///< from line to line, 1..255
  int bins = 0;        ///< > 0
  double bin_m = 0.0;  ///< bin k covers [k, k + 1) * bin_m; > 0

  bool full_circle() const { return width + step >= 6400; }
  double range_m() const { return bins * bin_m; }
};

struct SweepLine {
  int bearing = 0;                    ///< 0..6399
  std::vector<std::uint8_t> samples;  ///< SweepShape::bins of them, near to far
};

/// Draws turns of one shape; the way from pixel to sample is worked out once. Any thread, one at a time.
///
/// Each line fills its own step, from half a step before its bearing to half a step behind; of lines that
/// overlap, the later is seen. Nothing is made up between lines: where none came is background.
class SweepImage {
 public:
  SweepImage(const SweepShape& shape, const FanStyle& style);

  const SectorGeometry& geometry() const { return geometry_; }

  struct Projection {
    cv::Mat samples;  ///< CV_8UC1 of geometry().size(); smooth: linear between bins; 0: nothing was received
    cv::Mat covered;  ///< CV_8UC1, 255 where something was
  };
  Projection project(const std::vector<SweepLine>& lines, Resampling resampling = Resampling::smooth) const;

  /// project() in colour (CV_8UC3, BGR) with the grid, and `caption` in the top left corner.
  cv::Mat draw(const std::vector<SweepLine>& lines, const std::string& caption) const;

 private:
  void map_pixels();

  SweepShape shape_;
  SectorGeometry geometry_;
  FanStyle style_;
  int mapped_bins_;   ///< bins of the picture that the map looks into
  cv::Mat map_bins_;  ///< CV_32FC1: fractional bin of each pixel
  cv::Mat slots_;     ///< CV_32SC1: bearing of each pixel, in halves of a unit; -1 outside
  cv::Mat grid_;      ///< CV_8UC3, black where nothing is drawn
};

/// The samples of a turn as they came, CV_8UC1: a column for each step, clockwise from SweepShape::left (all
/// round: from astern, so that ahead is in the middle); a row for each bin, range upwards. A line is in the
/// column nearest to its bearing; a column without one is 0.
cv::Mat sweep_polar_image(const SweepShape& shape, const std::vector<SweepLine>& lines);

}  // namespace sonard::picture
