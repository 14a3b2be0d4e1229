// SPDX-License-Identifier: Apache-2.0
// Similarity of two images: the five measures of Cerqueira et al. 2017, 4.3 and table 4. Images are CV_64FC1
// of one size, values 0..255 (load_frame()). docs/sonarview.md defines the score in [0, 1] of each measure.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

namespace sonard::client {

/// Mean of the squared differences; 0 for identical images, at most 255^2.
double mean_squared_error(const cv::Mat& a, const cv::Mat& b);

/// PSNR of identical images: the paper uses 99 dB.
inline constexpr double most_psnr_db = 99.0;

/// Peak signal-to-noise ratio in dB, 10 log10(255^2 / MSE), at most most_psnr_db.
double psnr_db(const cv::Mat& a, const cv::Mat& b);

/// Structural similarity, Wang et al. 2004 (IEEE Trans. Image Processing 13:600): mean over all windows of 11
/// x 11 pixels within the image, Gaussian of 1.5 pixels, K1 = 0.01, K2 = 0.03. In [-1, 1], 1 for identical
/// images. nullopt if the images are smaller than a window.
std::optional<double> structural_similarity(const cv::Mat& a, const cv::Mat& b);

/// Structural similarity over five scales, Wang et al. 2003 (Asilomar Conf. 2:1398). Each scale has half the
/// width and height of the one before (means of 2 x 2 pixels). The result is a product of means: contrast and
/// structure at all scales, luminance at the last, to the powers 0.0448, 0.2856, 0.3001, 0.2363, 0.1333. A
/// mean below 0 counts as 0. In [0, 1]. nullopt if the smallest image is smaller than a window, i.e. the
/// images are less than 176 pixels wide or high.
std::optional<double> multi_scale_similarity(const cv::Mat& a, const cv::Mat& b);

/// Distance of two sets of SIFT descriptors (Lowe 2004, as OpenCV finds them), in [0, 1]: 0 for identical
/// images, near 1 for unrelated ones. Each keypoint of both images counts with its distance to the nearest
/// descriptor of the other image, as a share of the largest possible distance; the result is the mean. A
/// keypoint without a match counts as 1: its second nearest descriptor is less than 1.25 times as far (Lowe's
/// ratio 0.8). nullopt if neither image has a keypoint.
std::optional<double> sift_distance(const cv::Mat& a, const cv::Mat& b);

/// The five measures, and their scores in [0, 1].
struct Similarity {
  double mse = 0.0;
  double psnr_db = 0.0;
  std::optional<double> ssim = std::nullopt;
  std::optional<double> ms_ssim = std::nullopt;
  std::optional<double> sift_distance = std::nullopt;

  double mse_score() const;                  ///< MSE / 255^2: 0 is best
  double psnr_score() const;                 ///< PSNR / 99 dB: 1 is best
  std::optional<double> ssim_score() const;  ///< below 0 counts as 0: 1 is best
};

Similarity compare_images(const cv::Mat& a, const cv::Mat& b);

}  // namespace sonard::client
