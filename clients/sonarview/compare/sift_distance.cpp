// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <vector>

#include "clients/sonarview/compare/similarity.hpp"

namespace sonard::client {
namespace {

// OpenCV scales descriptors to length 512. Their components are not negative, so the angle between two of
// them is at most 90 degrees.
const double largest_distance = 512 * std::sqrt(2.0);
constexpr double ambiguous = 0.8;  // Lowe 2004, 7.1

cv::Mat descriptors_of(const cv::Mat& image) {
  cv::Mat grey;
  image.convertTo(grey, CV_8U);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::SIFT::create()->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
  return descriptors;
}

/// Sum of the distances of all keypoints of `from`, each 0 to 1.
double distances(const cv::Mat& from, const cv::Mat& to) {
  if (to.empty()) {
    return from.rows;
  }
  std::vector<std::vector<cv::DMatch>> nearest;
  cv::BFMatcher(cv::NORM_L2).knnMatch(from, to, nearest, 2);
  double sum = 0.0;
  for (const std::vector<cv::DMatch>& match : nearest) {
    const double first = static_cast<double>(match[0].distance);
    const double second = match.size() > 1 ? static_cast<double>(match[1].distance) : largest_distance;
    sum += first <= ambiguous * second ? std::min(first / largest_distance, 1.0) : 1.0;
  }
  return sum;
}

}  // namespace

std::optional<double> sift_distance(const cv::Mat& a, const cv::Mat& b) {
  const cv::Mat of_a = descriptors_of(a);
  const cv::Mat of_b = descriptors_of(b);
  const int keypoints = of_a.rows + of_b.rows;
  if (keypoints == 0) {
    return std::nullopt;
  }
  return (distances(of_a, of_b) + distances(of_b, of_a)) / keypoints;
}

}  // namespace sonard::client
