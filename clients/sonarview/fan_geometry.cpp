#include "clients/sonarview/fan_geometry.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace sonard::client {

FanGeometry::FanGeometry(FanShape shape, int radius_px, int margin_px)
    : shape_(std::move(shape)), radius_px_(radius_px) {
  const auto& bearings = shape_.bearings_rad;
  assert(bearings.size() >= 2 && shape_.lines > 0 && shape_.line_step_m > 0.0 && radius_px > 0);
  const double port_half_rad = 0.5 * (bearings[1] - bearings[0]);
  const double starboard_half_rad = 0.5 * (bearings.back() - bearings[bearings.size() - 2]);
  port_edge_rad_ = bearings.front() - port_half_rad;
  starboard_edge_rad_ = bearings.back() + starboard_half_rad;
  const double left_px = std::ceil(std::max(0.0, -radius_px_ * std::sin(port_edge_rad_)));
  const double right_px = std::ceil(std::max(0.0, radius_px_ * std::sin(starboard_edge_rad_)));
  size_ = {static_cast<int>(left_px + right_px) + 2 * margin_px + 1, radius_px + 2 * margin_px + 1};
  apex_ = {margin_px + left_px, static_cast<double>(margin_px + radius_px)};
}

cv::Point2d FanGeometry::pixel(double range_m, double bearing_rad) const {
  const double radius_px = range_m * pixels_per_metre();
  return {apex_.x + radius_px * std::sin(bearing_rad), apex_.y - radius_px * std::cos(bearing_rad)};
}

double FanGeometry::range_at(cv::Point2d pixel) const {
  return std::hypot(pixel.x - apex_.x, pixel.y - apex_.y) / pixels_per_metre();
}

double FanGeometry::bearing_at(cv::Point2d pixel) const {
  return std::atan2(pixel.x - apex_.x, apex_.y - pixel.y);
}

double FanGeometry::beam_at(double bearing_rad) const {
  if (bearing_rad < port_edge_rad_ || bearing_rad > starboard_edge_rad_) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto& bearings = shape_.bearings_rad;
  const auto above = std::upper_bound(bearings.begin() + 1, bearings.end() - 1, bearing_rad);
  const auto right = static_cast<std::size_t>(above - bearings.begin());
  const double left_rad = bearings[right - 1];
  return static_cast<double>(right - 1) + (bearing_rad - left_rad) / (bearings[right] - left_rad);
}

}  // namespace sonard::client
