// SPDX-License-Identifier: Apache-2.0
// The position of a range and a bearing in a picture of a sector seen from above.
#pragma once

#include <opencv2/core/types.hpp>

namespace sonard::picture {

/// A sector, up to the full circle. Ahead is up, port is on the left, and range increases away from the apex.
/// The picture has the size of the sector plus a margin for labels. Pixel coordinates are at pixel centres,
/// as in OpenCV. Bearings are in radians, 0 straight up, positive to the right.
class SectorGeometry {
 public:
  /// `radius_px`: pixels from the apex to the full range. Requires range_m > 0, radius_px > 0, port_edge_rad
  /// in [-pi, pi], and 0 < starboard_edge_rad - port_edge_rad <= 2 pi: a sector through astern ends beyond
  /// pi.
  SectorGeometry(double range_m, double port_edge_rad, double starboard_edge_rad, int radius_px,
                 int margin_px);

  cv::Size size() const { return size_; }
  cv::Point2d apex() const { return apex_; }
  double range_m() const { return range_m_; }
  double pixels_per_metre() const { return radius_px_ / range_m_; }
  double port_edge_rad() const { return port_edge_rad_; }
  double starboard_edge_rad() const { return starboard_edge_rad_; }
  bool full_circle() const;
  /// Whether the sector contains this bearing, modulo 2 pi.
  bool contains(double bearing_rad) const;

  cv::Point2d pixel(double range_m, double bearing_rad) const;
  double range_at(cv::Point2d pixel) const;    ///< metres from the apex
  double bearing_at(cv::Point2d pixel) const;  ///< in (-pi, pi]

 private:
  double range_m_;
  double port_edge_rad_;
  double starboard_edge_rad_;
  double radius_px_;
  cv::Size size_;
  cv::Point2d apex_;
};

}  // namespace sonard::picture
