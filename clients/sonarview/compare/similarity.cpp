// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/compare/similarity.hpp"

#include <algorithm>
#include <opencv2/core.hpp>

namespace sonard::client {
namespace {

constexpr double peak = 255;

}  // namespace

double mean_squared_error(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L2SQR) / static_cast<double>(a.total());
}

double psnr_db(const cv::Mat& a, const cv::Mat& b) {
  return std::min(cv::PSNR(a, b, peak), most_psnr_db);
}

double Similarity::mse_score() const {
  return mse / (peak * peak);
}

double Similarity::psnr_score() const {
  return std::max(psnr_db, 0.0) / most_psnr_db;
}

std::optional<double> Similarity::ssim_score() const {
  return ssim ? std::optional(std::max(*ssim, 0.0)) : std::nullopt;
}

Similarity compare_images(const cv::Mat& a, const cv::Mat& b) {
  return {mean_squared_error(a, b), psnr_db(a, b), structural_similarity(a, b), multi_scale_similarity(a, b),
          sift_distance(a, b)};
}

}  // namespace sonard::client
