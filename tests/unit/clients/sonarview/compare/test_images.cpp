// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/clients/sonarview/compare/test_images.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace sonard::client {

cv::Mat flat_image(int width, int height, double value) {
  return {height, width, CV_64FC1, cv::Scalar(value)};
}

cv::Mat checkerboard(int width, int height, double contrast) {
  cv::Mat image(height, width, CV_64FC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.at<double>(y, x) = 128 + ((x + y) % 2 == 0 ? contrast : -contrast);
    }
  }
  return image;
}

cv::Mat random_texture(int width, int height, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat image(height, width, CV_64FC1);
  random.fill(image, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(image, image, {0, 0}, 2.5);
  cv::normalize(image, image, 0.0, 255.0, cv::NORM_MINMAX);
  return image;
}

}  // namespace sonard::client
