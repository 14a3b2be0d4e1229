// Where a range and a bearing lie in a fan picture.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

namespace sonard::client {

/// What the samples of a ping stand for.
struct FanShape {
  std::vector<double> bearings_rad;  ///< centre of each beam, port (negative) to starboard, strictly rising
  int lines = 0;                     ///< > 0
  double line_step_m = 0.0;          ///< line i covers [i, i + 1) * line_step_m; > 0

  double range_m() const { return lines * line_step_m; }

  bool operator==(const FanShape&) const = default;
};

/// The fan seen from above: range grows upwards from the apex, port is on the left. The picture is as wide
/// and high as the fan needs, plus a margin for labels. Pixel coordinates name pixel centres, as in OpenCV.
class FanGeometry {
 public:
  /// `radius_px`: pixels from the apex to the full range. Requires at least two beams, bearings within
  /// +-90 degrees, radius_px > 0.
  FanGeometry(FanShape shape, int radius_px, int margin_px);

  const FanShape& shape() const { return shape_; }
  cv::Size size() const { return size_; }
  cv::Point2d apex() const { return apex_; }
  double pixels_per_metre() const { return radius_px_ / shape_.range_m(); }
  /// Bearing of the outer edges of the first and last beam, half a beam beyond their centres.
  double port_edge_rad() const { return port_edge_rad_; }
  double starboard_edge_rad() const { return starboard_edge_rad_; }

  cv::Point2d pixel(double range_m, double bearing_rad) const;
  double range_at(cv::Point2d pixel) const;    ///< metres from the apex
  double bearing_at(cv::Point2d pixel) const;  ///< radians, 0 straight up, positive to the right
  /// Fractional beam at a bearing: i at the centre of beam i, linear in between and for half a beam beyond
  /// the outer centres; NaN outside.
  double beam_at(double bearing_rad) const;

 private:
  FanShape shape_;
  double radius_px_;
  double port_edge_rad_;
  double starboard_edge_rad_;
  cv::Size size_;
  cv::Point2d apex_;
};

}  // namespace sonard::client
