// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture/sector_geometry.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace sonard::picture {
namespace {

constexpr double turn_rad = 2.0 * std::numbers::pi;
constexpr double rounding_rad = 1e-9;

}  // namespace

SectorGeometry::SectorGeometry(double range_m, double port_edge_rad, double starboard_edge_rad, int radius_px,
                               int margin_px)
    : range_m_(range_m),
      port_edge_rad_(port_edge_rad),
      starboard_edge_rad_(starboard_edge_rad),
      radius_px_(radius_px) {
  assert(range_m > 0.0 && radius_px > 0 && starboard_edge_rad > port_edge_rad &&
         starboard_edge_rad - port_edge_rad <= turn_rad + rounding_rad);
  // The extreme points of a sector are at its edges, or at one of the four main bearings if it contains them.
  double left = 0.0;
  double right = 0.0;
  double up = 0.0;
  double down = 0.0;
  const auto reach = [&](double bearing_rad) {
    left = std::max(left, -std::sin(bearing_rad));
    right = std::max(right, std::sin(bearing_rad));
    up = std::max(up, std::cos(bearing_rad));
    down = std::max(down, -std::cos(bearing_rad));
  };
  reach(port_edge_rad);
  reach(starboard_edge_rad);
  for (const double quarter : {-0.5, 0.0, 0.5, 1.0}) {
    if (contains(quarter * std::numbers::pi)) {
      reach(quarter * std::numbers::pi);
    }
  }
  const auto pixels = [&](double share) { return std::ceil(radius_px * share - rounding_rad); };
  size_ = {static_cast<int>(pixels(left) + pixels(right)) + 2 * margin_px + 1,
           static_cast<int>(pixels(up) + pixels(down)) + 2 * margin_px + 1};
  apex_ = {margin_px + pixels(left), margin_px + pixels(up)};
}

bool SectorGeometry::full_circle() const {
  return starboard_edge_rad_ - port_edge_rad_ >= turn_rad - rounding_rad;
}

bool SectorGeometry::contains(double bearing_rad) const {
  const double beyond_port_rad = bearing_rad - port_edge_rad_;
  const double offset_rad = beyond_port_rad - turn_rad * std::floor(beyond_port_rad / turn_rad);
  return offset_rad <= starboard_edge_rad_ - port_edge_rad_;
}

cv::Point2d SectorGeometry::pixel(double range_m, double bearing_rad) const {
  const double radius_px = range_m * pixels_per_metre();
  return {apex_.x + radius_px * std::sin(bearing_rad), apex_.y - radius_px * std::cos(bearing_rad)};
}

double SectorGeometry::range_at(cv::Point2d pixel) const {
  return std::hypot(pixel.x - apex_.x, pixel.y - apex_.y) / pixels_per_metre();
}

double SectorGeometry::bearing_at(cv::Point2d pixel) const {
  return std::atan2(pixel.x - apex_.x, apex_.y - pixel.y);
}

}  // namespace sonard::picture
