// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture/direction_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/amber.hpp"
#include "renderer/picture/polar_grid.hpp"

namespace sonard::picture {
namespace {

constexpr int caption_px = 26;
constexpr int gap_px = 6;
constexpr double text_scale = 0.45;

void put_text(cv::Mat& on, const std::string& text, cv::Point at) {
  cv::putText(on, text, at, cv::FONT_HERSHEY_SIMPLEX, text_scale, amber::label(), 1, cv::LINE_AA);
}

/// Share of the range, 0 near to 255 far, with the top row first.
cv::Mat nearness(const DirectionImage& image) {
  cv::Mat near(image.rows, image.columns, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const auto range_m =
          static_cast<double>(image.range_m[static_cast<std::size_t>(row * image.columns + column)]);
      near.at<std::uint8_t>(image.rows - 1 - row, column) =
          cv::saturate_cast<std::uint8_t>(255.0 * (1.0 - range_m / image.most_range_m));
    }
  }
  return near;
}

/// Where there are echoes, with the top row first.
cv::Mat echoing(const DirectionImage& image) {
  cv::Mat mask(image.rows, image.columns, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const bool echo = image.range_m[static_cast<std::size_t>(row * image.columns + column)] > 0.0F;
      mask.at<std::uint8_t>(image.rows - 1 - row, column) = echo ? 255 : 0;
    }
  }
  return mask;
}

cv::Mat colour_of(const cv::Mat& near) {
  cv::Mat colour;
  cv::applyColorMap(near, colour, cv::COLORMAP_TURBO);
  return colour;
}

cv::Mat draw_ranges(const DirectionImage& image) {
  cv::Mat ranges(image.rows, image.columns, CV_8UC3, amber::background());
  colour_of(nearness(image)).copyTo(ranges, echoing(image));
  return ranges;
}

cv::Mat draw_signals(const DirectionImage& image) {
  cv::Mat signals(image.rows, image.columns, CV_8UC1);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      signals.at<std::uint8_t>(image.rows - 1 - row, column) =
          image.signal[static_cast<std::size_t>(row * image.columns + column)];
    }
  }
  return amber::paint(signals, amber::Samples::decibels, echoing(image));
}

/// Points on a plane through the sonar, with rings of range. @param right, up coordinates in metres
template <class Right, class Up>
void draw_points(const DirectionImage& image, cv::Mat on, cv::Point2d origin, double pixels_per_metre,
                 Right right, Up up) {
  for (double ring_m = ring_step_m(image.most_range_m); ring_m <= image.most_range_m;
       ring_m += ring_step_m(image.most_range_m)) {
    cv::circle(on, origin, static_cast<int>(ring_m * pixels_per_metre), amber::grid(), 1, cv::LINE_AA);
    put_text(on, fmt::format("{:g} m", ring_m),
             {static_cast<int>(origin.x) + 3, static_cast<int>(origin.y - ring_m * pixels_per_metre) + 14});
  }
  const cv::Mat near = nearness(image);
  const cv::Mat colours = colour_of(near);
  for (std::size_t pixel = 0; pixel < image.range_m.size(); ++pixel) {
    if (image.range_m[pixel] <= 0.0F) {
      continue;
    }
    const cv::Point3f point = point_of(image, pixel);
    const int x = static_cast<int>(origin.x + static_cast<double>(right(point)) * pixels_per_metre);
    const int y = static_cast<int>(origin.y - static_cast<double>(up(point)) * pixels_per_metre);
    const int row = static_cast<int>(pixel) / image.columns, column = static_cast<int>(pixel) % image.columns;
    if (x >= 0 && x < on.cols && y >= 0 && y < on.rows) {
      on.at<cv::Vec3b>(y, x) = colours.at<cv::Vec3b>(image.rows - 1 - row, column);
    }
  }
}

}  // namespace

cv::Point3f point_of(const DirectionImage& image, std::size_t pixel) {
  const auto columns = static_cast<std::size_t>(image.columns);
  const double yaw =
      (static_cast<double>(pixel % columns) / (image.columns - 1) - 0.5) * image.horizontal_fov_rad;
  const double pitch =
      (static_cast<double>(pixel / columns) / (image.rows - 1) - 0.5) * image.vertical_fov_rad;
  const auto r = static_cast<double>(image.range_m[pixel]);
  return {static_cast<float>(r * std::cos(pitch) * std::cos(yaw)),
          static_cast<float>(r * std::cos(pitch) * std::sin(yaw)), static_cast<float>(-r * std::sin(pitch))};
}

cv::Mat draw(const DirectionImage& image, int height_px, const std::string& caption) {
  const int panel_px = (height_px - gap_px) / 2;
  const int image_px = 2 * panel_px;  // wide
  cv::Mat picture(caption_px + height_px, image_px + gap_px + height_px, CV_8UC3, amber::background());
  const auto place = [&](const cv::Mat& panel, int y) {
    cv::Mat part = picture(cv::Rect(0, caption_px + y, image_px, panel_px));
    cv::resize(panel, part, part.size(), 0, 0, cv::INTER_NEAREST);
  };
  place(draw_ranges(image), 0);
  place(draw_signals(image), panel_px + gap_px);
  const double half_h = image.horizontal_fov_rad / 2, half_v = image.vertical_fov_rad / 2;
  const double from_above_px =
      std::min(panel_px / image.most_range_m, height_px / 2 / (image.most_range_m * std::sin(half_h)));
  const double from_port_px =
      std::min(height_px / image.most_range_m, panel_px / 2 / (image.most_range_m * std::sin(half_v)));
  const int left = image_px + gap_px;
  draw_points(
      image, picture(cv::Rect(left, caption_px, height_px, panel_px)),
      {height_px / 2.0, static_cast<double>(panel_px)}, from_above_px,
      [](const cv::Point3f& point) { return point.y; }, [](const cv::Point3f& point) { return point.x; });
  draw_points(
      image, picture(cv::Rect(left, caption_px + panel_px + gap_px, height_px, panel_px)),
      {0.0, panel_px / 2.0}, from_port_px, [](const cv::Point3f& point) { return point.x; },
      [](const cv::Point3f& point) { return -point.z; });
  put_text(picture, caption, {8, 18});
  put_text(picture, "range", {8, caption_px + 18});
  put_text(picture, "signal", {8, caption_px + panel_px + gap_px + 18});
  put_text(picture, "from above", {left + 8, caption_px + 18});
  put_text(picture, "from the side, ahead to the right", {left + 8, caption_px + panel_px + gap_px + 18});
  return picture;
}

}  // namespace sonard::picture
