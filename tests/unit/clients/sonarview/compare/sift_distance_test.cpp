// SPDX-License-Identifier: Apache-2.0
// SIFT must find equal content again, also turned and shifted, and must not match other content.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "clients/sonarview/compare/similarity.hpp"
#include "tests/unit/clients/sonarview/compare/test_images.hpp"

namespace sonard::client {
namespace {

TEST(SiftDistance, OfAnImageToItselfIsZero) {
  const cv::Mat image = random_texture(200, 150, 11);
  EXPECT_EQ(sift_distance(image, image.clone()).value(), 0.0);
}

TEST(SiftDistance, OfUnrelatedImagesIsNearOne) {
  EXPECT_GT(sift_distance(random_texture(200, 150, 12), random_texture(200, 150, 13)).value(), 0.9);
}

TEST(SiftDistance, ATurnedImageIsFoundAgain) {
  const cv::Mat image = random_texture(150, 150, 14);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  EXPECT_LT(sift_distance(image, turned).value(), 0.35);
}

TEST(SiftDistance, GrowsWithWhatIsNew) {
  // An image whose right half is replaced.
  const cv::Mat image = random_texture(200, 150, 15);
  cv::Mat half_new = image.clone();
  random_texture(200, 150, 16).colRange(100, 200).copyTo(half_new.colRange(100, 200));
  const double distance = sift_distance(image, half_new).value();
  EXPECT_GT(distance, 0.3);
  EXPECT_LT(distance, 0.7);
}

TEST(SiftDistance, DoesNotDependOnTheOrder) {
  const cv::Mat a = random_texture(200, 150, 17);
  const cv::Mat b = 0.6 * a + 0.4 * random_texture(200, 150, 18);
  EXPECT_DOUBLE_EQ(sift_distance(a, b).value(), sift_distance(b, a).value());
}

TEST(SiftDistance, WithoutKeypoints) {
  const cv::Mat flat = flat_image(100, 100, 90);
  EXPECT_FALSE(sift_distance(flat, flat_image(100, 100, 10)));
  EXPECT_EQ(sift_distance(flat, random_texture(100, 100, 19)).value(), 1.0);
}

}  // namespace
}  // namespace sonard::client
