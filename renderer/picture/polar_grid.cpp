// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture/polar_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/amber.hpp"

namespace sonard::picture {
namespace {

constexpr int font = cv::FONT_HERSHEY_DUPLEX;
constexpr double font_scale = 0.5;
constexpr int label_gap_px = 8;
constexpr double most_rings = 8.0;
/// A round range may end slightly short, cut to whole lines; its ring is drawn anyway.
constexpr double whole_range_slack = 1.003;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}
double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

cv::Point rounded(cv::Point2d point) {
  return {cvRound(point.x), cvRound(point.y)};
}

std::string metres_text(double metres) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g m", metres);
  return text.data();
}

/// `anchor` is the left (0), centre (0.5) or right (1) end of the text, at half its height. The font has no
/// degree sign, so a ring is drawn instead.
void put_label(cv::Mat& image, const std::string& text, cv::Point2d at, double anchor,
               bool in_degrees = false) {
  const cv::Size size = cv::getTextSize(text, font, font_scale, 1, nullptr);
  const cv::Point2d left_bottom{at.x - anchor * size.width, at.y + 0.5 * size.height};
  cv::putText(image, text, rounded(left_bottom), font, font_scale, amber::label(), 1, cv::LINE_AA);
  if (in_degrees) {
    const cv::Point2d right_top{left_bottom.x + size.width + 3.0, left_bottom.y - size.height + 1.0};
    cv::circle(image, rounded(right_top), 2, amber::label(), 1, cv::LINE_AA);
  }
}

/// Outside the starboard edge; in a full circle, to the right of the line ahead.
void put_ring_label(cv::Mat& grid, const SectorGeometry& geometry, double radius_m) {
  if (geometry.full_circle()) {
    const cv::Point2d end = geometry.pixel(radius_m, 0.0);
    put_label(grid, metres_text(radius_m), {end.x + label_gap_px, end.y + 1.5 * label_gap_px}, 0.0);
    return;
  }
  const double edge_rad = geometry.starboard_edge_rad();
  const cv::Point2d end = geometry.pixel(radius_m, edge_rad);
  // Perpendicular to the edge; at 60 degrees, 8 pixels right and 12 down.
  const double right = std::cos(edge_rad);
  const double anchor = right > 0.3 ? 0.0 : right < -0.3 ? 1.0 : 0.5;
  put_label(grid, metres_text(radius_m),
            {end.x + 2.0 * label_gap_px * right, end.y + 1.732 * label_gap_px * std::sin(edge_rad)}, anchor);
}

void draw_rings(cv::Mat& grid, const SectorGeometry& geometry) {
  const double range_m = geometry.range_m();
  const double step_m = ring_step_m(range_m);
  // OpenCV counts angles clockwise from the right.
  const auto arc = [&](double radius_m) {
    const int radius_px = cvRound(radius_m * geometry.pixels_per_metre());
    cv::ellipse(grid, rounded(geometry.apex()), {radius_px, radius_px}, 0.0,
                degrees(geometry.port_edge_rad()) - 90.0, degrees(geometry.starboard_edge_rad()) - 90.0,
                amber::grid(), 1, cv::LINE_AA);
  };
  arc(range_m);
  for (int ring = 1; ring * step_m <= range_m * whole_range_slack; ++ring) {
    arc(std::min(ring * step_m, range_m));
    put_ring_label(grid, geometry, ring * step_m);
  }
}

void draw_bearing(cv::Mat& grid, const SectorGeometry& geometry, int bearing_deg) {
  double bearing_rad = radians(bearing_deg);
  if (!geometry.contains(bearing_rad)) {
    bearing_rad = std::clamp(bearing_rad, geometry.port_edge_rad(), geometry.starboard_edge_rad());
  }
  const cv::Point2d end = geometry.pixel(geometry.range_m(), bearing_rad);
  cv::line(grid, rounded(geometry.apex()), rounded(end), amber::grid(), 1, cv::LINE_AA);
  const cv::Point2d beyond =
      geometry.pixel(geometry.range_m() + 2.2 * label_gap_px / geometry.pixels_per_metre(), bearing_rad);
  put_label(grid, std::to_string(bearing_deg), beyond, 0.5, true);
}

}  // namespace

double ring_step_m(double range_m) {
  double step_m = std::pow(10.0, std::floor(std::log10(range_m)) - 1.0);
  for (const double factor : {2.0, 2.5, 2.0, 2.0, 2.5}) {  // 1, 2, 5, 10, 20, 50
    if (range_m / step_m <= most_rings) {
      break;
    }
    step_m *= factor;
  }
  return step_m;
}

std::vector<int> round_bearings_deg(const SectorGeometry& geometry) {
  const double width_deg = degrees(geometry.starboard_edge_rad() - geometry.port_edge_rad());
  const int step_deg = width_deg > 90.0 ? 30 : width_deg > 30.0 ? 10 : 5;
  std::vector<int> bearings_deg;
  for (int bearing_deg = -180 + step_deg; bearing_deg <= 180; bearing_deg += step_deg) {
    if (geometry.contains(radians(bearing_deg))) {
      bearings_deg.push_back(bearing_deg);
    }
  }
  return bearings_deg;
}

cv::Mat polar_grid(const SectorGeometry& geometry, const std::vector<int>& bearings_deg) {
  cv::Mat grid = cv::Mat::zeros(geometry.size(), CV_8UC3);
  draw_rings(grid, geometry);
  for (const int bearing_deg : bearings_deg) {
    draw_bearing(grid, geometry, bearing_deg);
  }
  return grid;
}

void add_grid(cv::Mat& picture, const cv::Mat& grid, const std::string& caption) {
  cv::max(picture, grid, picture);
  put_label(picture, caption, {grid_margin_px / 4.0, grid_margin_px / 3.0}, 0.0);
}

}  // namespace sonard::picture
