// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture/amber.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

namespace sonard::picture::amber {
namespace {

struct Stop {
  double value;
  cv::Vec3d bgr;
};

// From nearly black through copper and amber to a warm white.
constexpr std::size_t stop_count = 6;
const std::array<Stop, stop_count>& stops() {
  static const std::array<Stop, stop_count> all{{{0.0, {10, 6, 4}},
                                                 {40.0, {14, 26, 58}},
                                                 {96.0, {22, 66, 138}},
                                                 {160.0, {34, 124, 212}},
                                                 {216.0, {94, 190, 248}},
                                                 {255.0, {222, 244, 255}}}};
  return all;
}

cv::Vec3b colour_of(double value) {
  std::size_t upper = 1;
  while (upper + 1 < stop_count && stops()[upper].value < value) {
    ++upper;
  }
  const Stop& from = stops()[upper - 1];
  const Stop& to = stops()[upper];
  const double part = (value - from.value) / (to.value - from.value);
  const cv::Vec3d bgr = from.bgr * (1.0 - part) + to.bgr * part;
  return {cv::saturate_cast<uchar>(bgr[0]), cv::saturate_cast<uchar>(bgr[1]),
          cv::saturate_cast<uchar>(bgr[2])};
}

}  // namespace

cv::Mat palette(Samples samples) {
  cv::Mat colours(1, 256, CV_8UC3);
  for (int value = 0; value < 256; ++value) {
    colours.at<cv::Vec3b>(0, value) =
        colour_of(samples == Samples::amplitudes ? std::sqrt(255.0 * value) : value);
  }
  return colours;
}

cv::Mat paint(const cv::Mat& values, Samples samples, const cv::Mat& inside) {
  static const cv::Mat of_amplitudes = palette(Samples::amplitudes);
  static const cv::Mat of_decibels = palette(Samples::decibels);
  cv::Mat grey;
  cv::cvtColor(values, grey, cv::COLOR_GRAY2BGR);
  cv::Mat coloured;
  cv::LUT(grey, samples == Samples::amplitudes ? of_amplitudes : of_decibels, coloured);
  cv::Mat picture(values.size(), CV_8UC3, background());
  coloured.copyTo(picture, inside);
  return picture;
}

cv::Scalar background() {
  return {26, 17, 12};
}
cv::Scalar grid() {
  return {104, 92, 74};
}
cv::Scalar label() {
  return {190, 182, 168};
}

}  // namespace sonard::picture::amber
