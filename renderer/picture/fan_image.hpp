// SPDX-License-Identifier: Apache-2.0
// Pictures of a ping: the fan seen from above, and the raw samples.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "renderer/picture/fan_geometry.hpp"

namespace sonard::picture {

struct FanStyle {
  int radius_px = 900;  ///< from the apex to the full range
  bool grid = true;     ///< range arcs with metres, bearing lines with degrees, caption
};

/// How a pixel is computed from the samples around it: `smooth` for samples, `nearest` for labels, because it
/// interpolates no values.
enum class Resampling { smooth, nearest };

/// Draws pings of one shape; the map from pixel to sample is computed once. Any thread, one at a time.
class FanImage {
 public:
  FanImage(const FanShape& shape, const FanStyle& style);

  const FanGeometry& geometry() const { return geometry_; }

  /// Resamples a ping to the fan: CV_8UC1 of geometry().size(), 0 outside the fan. `polar`: CV_8UC1, one row
  /// per line, near lines first, one column per beam. Smooth: bilinear; if lines are finer than pixels, they
  /// are averaged first.
  cv::Mat project(const cv::Mat& polar, Resampling resampling = Resampling::smooth) const;

  /// project() in colour (CV_8UC3, BGR), with the grid, and `caption` in the top left corner.
  cv::Mat draw(const cv::Mat& polar, const std::string& caption) const;

 private:
  void map_pixels();

  FanGeometry geometry_;
  FanStyle style_;
  int mapped_lines_;   ///< rows of the image that the maps refer to
  cv::Mat map_beams_;  ///< CV_32FC1: fractional column of each pixel
  cv::Mat map_lines_;  ///< CV_32FC1: fractional row
  cv::Mat inside_;     ///< CV_8UC1: 255 within the fan
  cv::Mat grid_;       ///< CV_8UC3, black if not drawn
};

/// Converts a map into `mapped` samples to `samples` over the same range; sample k has its centre at k.
cv::Mat finer(const cv::Mat& map, int samples, int mapped);

/// The raw samples, CV_8UC1: one column per beam, port on the left; one row per line, range upwards.
cv::Mat raw_polar_image(const cv::Mat& polar);

}  // namespace sonard::picture
