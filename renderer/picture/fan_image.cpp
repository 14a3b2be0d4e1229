// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture/fan_image.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "renderer/picture/amber.hpp"
#include "renderer/picture/polar_grid.hpp"

namespace sonard::picture {
namespace {

/// A fan of 120 degrees has lines at +-60 degrees, although its outer beams end slightly before.
std::vector<int> bearing_lines_deg(const SectorGeometry& geometry) {
  constexpr double wide_rad = 110.0 * std::numbers::pi / 180.0;
  return geometry.starboard_edge_rad() - geometry.port_edge_rad() > wide_rad
             ? std::vector<int>{-60, -30, 0, 30, 60}
             : round_bearings_deg(geometry);
}

}  // namespace

cv::Mat finer(const cv::Mat& map, int samples, int mapped) {
  const double ratio = static_cast<double>(samples) / mapped;
  return (map + 0.5) * ratio - 0.5;
}

cv::Mat raw_polar_image(const cv::Mat& polar) {
  cv::Mat upwards;
  cv::flip(polar, upwards, 0);
  return upwards;
}

FanImage::FanImage(const FanShape& shape, const FanStyle& style)
    : geometry_(shape, style.radius_px, style.grid ? grid_margin_px : 0),
      style_(style),
      mapped_lines_(std::min(shape.lines, style.radius_px)) {
  map_pixels();
  if (style.grid) {
    grid_ = polar_grid(geometry_, bearing_lines_deg(geometry_));
  }
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

cv::Mat FanImage::project(const cv::Mat& polar, Resampling resampling) const {
  CV_Assert(polar.type() == CV_8UC1 && polar.rows == geometry_.shape().lines &&
            polar.cols == static_cast<int>(geometry_.shape().bearings_rad.size()));
  cv::Mat fan;
  if (resampling == Resampling::nearest) {
    cv::remap(polar, fan, map_beams_, finer(map_lines_, polar.rows, mapped_lines_), cv::INTER_NEAREST,
              cv::BORDER_REPLICATE);
  } else {
    cv::Mat source = polar;
    if (mapped_lines_ < polar.rows) {
      cv::resize(polar, source, {polar.cols, mapped_lines_}, 0.0, 0.0, cv::INTER_AREA);
    }
    cv::remap(source, fan, map_beams_, map_lines_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  }
  cv::Mat masked = cv::Mat::zeros(fan.size(), fan.type());
  fan.copyTo(masked, inside_);
  return masked;
}

cv::Mat FanImage::draw(const cv::Mat& polar, const std::string& caption) const {
  cv::Mat picture = amber::paint(project(polar), amber::Samples::amplitudes, inside_);
  if (style_.grid) {
    add_grid(picture, grid_, caption);
  }
  return picture;
}

}  // namespace sonard::picture
