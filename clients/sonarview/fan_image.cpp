#include "clients/sonarview/fan_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "clients/sonarview/amber.hpp"

namespace sonard::client {
namespace {

constexpr int margin_px = 68;
constexpr int font = cv::FONT_HERSHEY_DUPLEX;
constexpr double font_scale = 0.5;
constexpr int label_gap_px = 8;
constexpr double most_rings = 8.0;
/// A range that was meant to be round is cut to whole lines; its ring is wanted all the same.
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

/// `anchor` is the left (0), centre (0.5) or right (1) end of the text, at half its height. The font knows no
/// degree sign; a ring is drawn in its place.
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

cv::Mat raw_polar_image(const cv::Mat& polar) {
  cv::Mat upwards;
  cv::flip(polar, upwards, 0);
  return upwards;
}

FanImage::FanImage(const FanShape& shape, const FanLook& look)
    : geometry_(shape, look.radius_px, look.grid ? margin_px : 0),
      look_(look),
      mapped_lines_(std::min(shape.lines, look.radius_px)),
      palette_(amber::palette()) {
  map_pixels();
  draw_grid();
}

void FanImage::map_pixels() {
  const cv::Size size = geometry_.size();
  map_beams_.create(size, CV_32FC1);
  map_lines_.create(size, CV_32FC1);
  inside_ = cv::Mat::zeros(size, CV_8UC1);
  const double lines_per_metre = mapped_lines_ / geometry_.shape().range_m();
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const cv::Point2d pixel(x, y);
      const double range_m = geometry_.range_at(pixel);
      const double beam = geometry_.beam_at(geometry_.bearing_at(pixel));
      const bool inside = !std::isnan(beam) && range_m < geometry_.shape().range_m();
      inside_.at<uchar>(y, x) = inside ? 255 : 0;
      map_beams_.at<float>(y, x) = inside ? static_cast<float>(beam) : 0.0F;
      // The centre of line i is at i + 0.5 steps.
      map_lines_.at<float>(y, x) = inside ? static_cast<float>(range_m * lines_per_metre - 0.5) : 0.0F;
    }
  }
}

void FanImage::draw_grid() {
  grid_ = cv::Mat::zeros(geometry_.size(), CV_8UC3);
  if (!look_.grid) {
    return;
  }
  const double range_m = geometry_.shape().range_m();
  const cv::Point apex = rounded(geometry_.apex());
  const double port_deg = degrees(geometry_.port_edge_rad());
  const double starboard_deg = degrees(geometry_.starboard_edge_rad());
  const double step_m = ring_step_m(range_m);
  // OpenCV counts angles clockwise from the right.
  const auto arc = [&](double radius_m) {
    const int radius_px = cvRound(radius_m * geometry_.pixels_per_metre());
    cv::ellipse(grid_, apex, {radius_px, radius_px}, 0.0, port_deg - 90.0, starboard_deg - 90.0,
                amber::grid(), 1, cv::LINE_AA);
  };
  arc(range_m);
  for (int ring = 1; ring * step_m <= range_m * whole_range_slack; ++ring) {
    arc(std::min(ring * step_m, range_m));
    const cv::Point2d end = geometry_.pixel(ring * step_m, geometry_.starboard_edge_rad());
    put_label(grid_, metres_text(ring * step_m), {end.x + label_gap_px, end.y + 1.5 * label_gap_px}, 0.0);
  }
  for (const int bearing_deg : {-60, -30, 0, 30, 60}) {
    const double bearing_rad =
        std::clamp(radians(bearing_deg), geometry_.port_edge_rad(), geometry_.starboard_edge_rad());
    const cv::Point2d end = geometry_.pixel(range_m, bearing_rad);
    cv::line(grid_, apex, rounded(end), amber::grid(), 1, cv::LINE_AA);
    const cv::Point2d beyond =
        geometry_.pixel(range_m + 2.2 * label_gap_px / geometry_.pixels_per_metre(), bearing_rad);
    put_label(grid_, std::to_string(bearing_deg), beyond, 0.5, true);
  }
}

cv::Mat FanImage::project(const cv::Mat& polar) const {
  CV_Assert(polar.type() == CV_8UC1 && polar.rows == geometry_.shape().lines &&
            polar.cols == static_cast<int>(geometry_.shape().bearings_rad.size()));
  cv::Mat source = polar;
  if (mapped_lines_ < polar.rows) {
    cv::resize(polar, source, {polar.cols, mapped_lines_}, 0.0, 0.0, cv::INTER_AREA);
  }
  cv::Mat fan;
  cv::remap(source, fan, map_beams_, map_lines_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::Mat masked = cv::Mat::zeros(fan.size(), fan.type());
  fan.copyTo(masked, inside_);
  return masked;
}

cv::Mat FanImage::draw(const cv::Mat& polar, const std::string& caption) const {
  cv::Mat bgr;
  cv::cvtColor(project(polar), bgr, cv::COLOR_GRAY2BGR);
  cv::Mat coloured;
  cv::LUT(bgr, palette_, coloured);
  cv::Mat picture(geometry_.size(), CV_8UC3, amber::background());
  coloured.copyTo(picture, inside_);
  cv::max(picture, grid_, picture);  // the grid gives way to echoes
  if (look_.grid) {
    put_label(picture, caption, {margin_px / 4.0, margin_px / 3.0}, 0.0);
  }
  return picture;
}

}  // namespace sonard::client
