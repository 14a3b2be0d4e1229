// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/ping1d/waterfall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/amber.hpp"
#include "renderer/picture/polar_grid.hpp"

namespace sonard::client {
namespace {

namespace amber = picture::amber;

constexpr std::size_t most_pings = 400;
constexpr int column_px = 2;
constexpr int caption_px = 26;
const cv::Scalar distance_colour{255, 230, 90};

double end_mm(const ping1d::Distance& measured) {
  return static_cast<double>(measured.scan_start_mm) + measured.scan_length_mm;
}

void put_text(cv::Mat& image, const std::string& text, cv::Point at) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, amber::label(), 1, cv::LINE_AA);
}

}  // namespace

std::string measurement_text(const ping1d::Distance& measured) {
  return fmt::format("distance {:.3f} m   confidence {} %   scan {:.2f} to {:.2f} m   gain {}",
                     1e-3 * measured.distance_mm, measured.confidence_percent, 1e-3 * measured.scan_start_mm,
                     1e-3 * end_mm(measured), measured.gain_setting);
}

void Waterfall::add(const ping1d::ReceivedPing& ping) {
  pings_.push_back(ping);
  if (pings_.size() > most_pings) {
    pings_.pop_front();
  }
}

double Waterfall::range_mm() const {
  double range_mm = 1.0;
  for (const ping1d::ReceivedPing& ping : pings_) {
    range_mm = std::max(range_mm, end_mm(ping.measured));
  }
  return range_mm;
}

cv::Mat Waterfall::samples() const {
  cv::Mat found(height_px_, static_cast<int>(most_pings), CV_8UC1, cv::Scalar(0));
  const double pixel_mm = range_mm() / height_px_;
  int column = found.cols - static_cast<int>(pings_.size());
  for (const ping1d::ReceivedPing& ping : pings_) {
    const auto points = static_cast<double>(ping.profile.size());
    const double point_px = ping.measured.scan_length_mm / std::max(1.0, points) / pixel_mm;
    double at = ping.measured.scan_start_mm / pixel_mm;
    for (const std::uint8_t strength : ping.profile) {  // the strongest of the points in a row
      const int end =
          std::min(height_px_, std::max(static_cast<int>(at) + 1, static_cast<int>(at + point_px)));
      for (int row = static_cast<int>(at); row < end; ++row) {
        std::uint8_t& cell = found.at<std::uint8_t>(row, column);
        cell = std::max(cell, strength);
      }
      at += point_px;
    }
    ++column;
  }
  return found;
}

cv::Mat Waterfall::draw() const {
  const double range_m = 1e-3 * range_mm();
  cv::Mat wide;
  cv::resize(samples(), wide, {}, column_px, 1.0, cv::INTER_NEAREST);
  cv::Mat echoes =
      amber::paint(wide, amber::Samples::amplitudes, cv::Mat(wide.size(), CV_8UC1, cv::Scalar(255)));
  int column = static_cast<int>(most_pings - pings_.size());
  for (const ping1d::ReceivedPing& ping : pings_) {
    const int row = static_cast<int>(1e-3 * ping.measured.distance_mm / range_m * height_px_);
    if (ping.measured.confidence_percent > 0 && row < height_px_) {
      cv::line(echoes, {column * column_px, row}, {column * column_px + column_px - 1, row}, distance_colour);
    }
    ++column;
  }
  cv::Mat picture(height_px_ + caption_px, echoes.cols + picture::grid_margin_px, CV_8UC3,
                  amber::background());
  echoes.copyTo(picture(cv::Rect(0, caption_px, echoes.cols, echoes.rows)));
  const double step_m = picture::ring_step_m(range_m);
  for (double depth_m = step_m; depth_m < range_m; depth_m += step_m) {
    const int row = caption_px + static_cast<int>(depth_m / range_m * height_px_);
    cv::line(picture, {echoes.cols - 12, row}, {echoes.cols + 5, row}, amber::label());
    put_text(picture, fmt::format("{:g} m", depth_m), {echoes.cols + 9, row + 5});
  }
  if (!pings_.empty()) {
    put_text(picture, measurement_text(pings_.back().measured), {8, 18});
  }
  return picture;
}

}  // namespace sonard::client
