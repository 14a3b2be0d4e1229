// SPDX-License-Identifier: Apache-2.0
// MSE, PSNR, SSIM and MS-SSIM against numbers calculated by hand and against the formulas of Wang et al.,
// summed pixel by pixel.
#include "clients/sonarview/compare/similarity.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "tests/unit/clients/sonarview/compare/test_images.hpp"

namespace sonard::client {
namespace {

constexpr double c1 = 6.5025;   // (0.01 * 255)^2
constexpr double c2 = 58.5225;  // (0.03 * 255)^2

/// Means over all windows of contrast times structure, and of contrast times structure times luminance
/// (Wang et al. 2004, eq. 12-16), with sums written out.
std::pair<double, double> terms_by_hand(const cv::Mat& a, const cv::Mat& b) {
  double sum_cs = 0;
  double sum_all = 0;
  int windows = 0;
  for (int y = 5; y < a.rows - 5; ++y) {
    for (int x = 5; x < a.cols - 5; ++x) {
      double weights = 0;
      double ma = 0;
      double mb = 0;
      for (int dy = -5; dy <= 5; ++dy) {
        for (int dx = -5; dx <= 5; ++dx) {
          const double weight = std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5));
          weights += weight;
          ma += weight * a.at<double>(y + dy, x + dx);
          mb += weight * b.at<double>(y + dy, x + dx);
        }
      }
      ma /= weights;
      mb /= weights;
      double va = 0;
      double vb = 0;
      double cov = 0;
      for (int dy = -5; dy <= 5; ++dy) {
        for (int dx = -5; dx <= 5; ++dx) {
          const double weight = std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5)) / weights;
          const double da = a.at<double>(y + dy, x + dx) - ma;
          const double db = b.at<double>(y + dy, x + dx) - mb;
          va += weight * da * da;
          vb += weight * db * db;
          cov += weight * da * db;
        }
      }
      const double cs = (2 * cov + c2) / (va + vb + c2);
      sum_cs += cs;
      sum_all += cs * (2 * ma * mb + c1) / (ma * ma + mb * mb + c1);
      ++windows;
    }
  }
  return {sum_cs / windows, sum_all / windows};
}

cv::Mat half_by_hand(const cv::Mat& image) {
  cv::Mat half(image.rows / 2, image.cols / 2, CV_64FC1);
  for (int y = 0; y < half.rows; ++y) {
    for (int x = 0; x < half.cols; ++x) {
      half.at<double>(y, x) = (image.at<double>(2 * y, 2 * x) + image.at<double>(2 * y, 2 * x + 1) +
                               image.at<double>(2 * y + 1, 2 * x) + image.at<double>(2 * y + 1, 2 * x + 1)) /
                              4;
    }
  }
  return half;
}

TEST(Similarity, IdenticalImages) {
  const cv::Mat image = random_texture(180, 200, 1);
  const Similarity same = compare_images(image, image.clone());
  EXPECT_EQ(same.mse_score(), 0.0);
  EXPECT_EQ(same.psnr_db, 99.0);
  EXPECT_EQ(same.psnr_score(), 1.0);
  EXPECT_NEAR(same.ssim_score().value(), 1.0, 1e-12);
  EXPECT_NEAR(same.ms_ssim.value(), 1.0, 1e-12);
  EXPECT_EQ(same.sift_distance.value(), 0.0);
}

TEST(Similarity, MeanSquaredErrorByHand) {
  // 4 of 16 pixels differ by 10, and 1 by -20: (4 * 100 + 400) / 16 = 50.
  const cv::Mat a = flat_image(4, 4, 100);
  cv::Mat b = a.clone();
  b.row(2) += 10;
  b.at<double>(0, 3) = 80;
  EXPECT_DOUBLE_EQ(mean_squared_error(a, b), 50);
  EXPECT_NEAR(psnr_db(a, b), 31.141103, 1e-6);  // 10 log10(65025 / 50)
  const Similarity similarity{.mse = 50, .psnr_db = 31.141103, .ssim = -0.2};
  EXPECT_NEAR(similarity.mse_score(), 7.689350e-4, 1e-10);  // 50 / 65025
  EXPECT_NEAR(similarity.psnr_score(), 0.314556596, 1e-9);  // of 99 dB
  EXPECT_EQ(similarity.ssim_score().value(), 0.0);
}

TEST(Similarity, BlackAgainstWhiteIsTheWorst) {
  const Similarity worst = compare_images(flat_image(200, 180, 0), flat_image(200, 180, 255));
  EXPECT_DOUBLE_EQ(worst.mse_score(), 1.0);
  EXPECT_NEAR(worst.psnr_score(), 0.0, 1e-12);
  EXPECT_NEAR(worst.ssim.value(), 9.999000e-5, 1e-10);  // c1 / (255^2 + c1)
}

TEST(Similarity, ConstantOffsetChangesLuminanceOnly) {
  // (2 a b + c1) / (a^2 + b^2 + c1) with a = 100, b = 150. At the last scale it has the power 0.1333.
  const cv::Mat a = flat_image(192, 180, 100);
  const cv::Mat b = flat_image(192, 180, 150);
  EXPECT_NEAR(structural_similarity(a, b).value(), 30006.5025 / 32506.5025, 1e-9);
  EXPECT_NEAR(multi_scale_similarity(a, b).value(), std::pow(30006.5025 / 32506.5025, 0.1333), 1e-9);
}

TEST(Similarity, SumsOverWindows) {
  const cv::Mat a = random_texture(23, 19, 2);
  const cv::Mat b = 0.5 * a + 0.5 * random_texture(23, 19, 3);
  EXPECT_NEAR(structural_similarity(a, b).value(), terms_by_hand(a, b).second, 1e-9);
}

TEST(Similarity, InvertedContrastIsNegative) {
  // Both variances are s^2 and the covariance is -s^2: (c2 - 2 s^2) / (c2 + 2 s^2) with s = 50. The means are
  // equal.
  const cv::Mat a = checkerboard(40, 30, 50);
  const cv::Mat b = checkerboard(40, 30, -50);
  EXPECT_NEAR(structural_similarity(a, b).value(), (58.5225 - 5000) / (58.5225 + 5000), 1e-4);
}

TEST(Similarity, OneScaleOfFive) {
  // A board of single pixels is flat at all scales but the first, so the result has the power of the first
  // scale's weight, 0.0448.
  const cv::Mat a = checkerboard(180, 180, 60);
  const cv::Mat b = checkerboard(180, 180, 15);
  const double first = (2 * 60.0 * 15 + c2) / (60.0 * 60 + 15.0 * 15 + c2);
  EXPECT_NEAR(multi_scale_similarity(a, b).value(), std::pow(first, 0.0448), 1e-6);
}

TEST(Similarity, AllScales) {
  constexpr std::array<double, 5> weights{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};  // Wang et al. 2003, 4
  cv::Mat a = random_texture(181, 177, 4);
  cv::Mat b = 0.7 * a + 0.3 * random_texture(181, 177, 5);
  const double measured = multi_scale_similarity(a, b).value();
  double product = 1;
  for (std::size_t scale = 0; scale < weights.size(); ++scale) {
    const auto [contrast_structure, all] = terms_by_hand(a, b);
    product *= std::pow(scale == 4 ? all : contrast_structure, weights[scale]);
    a = half_by_hand(a);
    b = half_by_hand(b);
  }
  EXPECT_NEAR(measured, product, 1e-9);
  EXPECT_LT(product, 0.95);
}

TEST(Similarity, SmallImagesHaveNoWindows) {
  EXPECT_FALSE(structural_similarity(flat_image(10, 50, 1), flat_image(10, 50, 1)));
  EXPECT_TRUE(structural_similarity(flat_image(11, 11, 1), flat_image(11, 11, 1)));
  EXPECT_FALSE(multi_scale_similarity(flat_image(175, 300, 1), flat_image(175, 300, 1)));
  EXPECT_TRUE(multi_scale_similarity(flat_image(176, 300, 1), flat_image(176, 300, 1)));
}

}  // namespace
}  // namespace sonard::client
