// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

#include "clients/sonarview/compare/similarity.hpp"

namespace sonard::client {
namespace {

constexpr int window_px = 11;
constexpr double window_sd_px = 1.5;
constexpr double c1 = (0.01 * 255) * (0.01 * 255);
constexpr double c2 = (0.03 * 255) * (0.03 * 255);
constexpr std::array<double, 5> scale_weights{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};

bool has_window(const cv::Mat& image) {
  return std::min(image.rows, image.cols) >= window_px;
}

/// Weighted mean over the window of each pixel; pixels whose window leaves the image are cut off.
cv::Mat windowed(const cv::Mat& image) {
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, {window_px, window_px}, window_sd_px, window_sd_px);
  const int border = window_px / 2;
  return blurred(cv::Rect(border, border, image.cols - 2 * border, image.rows - 2 * border));
}

struct MeanTerms {
  double contrast_structure = 0.0;
  double all = 0.0;  ///< mean of contrast and structure times luminance, per pixel
};

MeanTerms mean_terms(const cv::Mat& a, const cv::Mat& b) {
  const cv::Mat mean_a = windowed(a);
  const cv::Mat mean_b = windowed(b);
  const cv::Mat squares = mean_a.mul(mean_a) + mean_b.mul(mean_b);
  const cv::Mat product = mean_a.mul(mean_b);
  const cv::Mat variances = windowed(a.mul(a) + b.mul(b)) - squares;
  const cv::Mat covariance = windowed(a.mul(b)) - product;
  cv::Mat contrast_structure;
  cv::divide(2 * covariance + c2, variances + c2, contrast_structure);
  cv::Mat luminance;
  cv::divide(2 * product + c1, squares + c1, luminance);
  return {cv::mean(contrast_structure)[0], cv::mean(contrast_structure.mul(luminance))[0]};
}

/// Means of 2 x 2 pixels; drops an odd last row or column.
cv::Mat halved(const cv::Mat& image) {
  const cv::Size size(image.cols / 2, image.rows / 2);
  cv::Mat half;
  cv::resize(image(cv::Rect(0, 0, 2 * size.width, 2 * size.height)), half, size, 0.0, 0.0, cv::INTER_AREA);
  return half;
}

}  // namespace

std::optional<double> structural_similarity(const cv::Mat& a, const cv::Mat& b) {
  return has_window(a) ? std::optional(mean_terms(a, b).all) : std::nullopt;
}

std::optional<double> multi_scale_similarity(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat a_scaled = a;
  cv::Mat b_scaled = b;
  double product = 1.0;
  for (std::size_t scale = 0; scale < scale_weights.size(); ++scale) {
    if (scale > 0) {
      a_scaled = halved(a_scaled);
      b_scaled = halved(b_scaled);
    }
    if (!has_window(a_scaled)) {
      return std::nullopt;
    }
    const MeanTerms terms = mean_terms(a_scaled, b_scaled);
    const bool last = scale + 1 == scale_weights.size();
    product *= std::pow(std::max(last ? terms.all : terms.contrast_structure, 0.0), scale_weights[scale]);
  }
  return product;
}

}  // namespace sonard::client
