// SPDX-License-Identifier: Apache-2.0
// The colours of a sonar display: echoes glow from copper to amber to white on a night-blue ground.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace sonard::picture::amber {

/// BGR colour of each sample value: 1 x 256, CV_8UC3. Brightness rises strictly with the value, so that a
/// picture reads the same in grey.
cv::Mat palette();

/// Samples (CV_8UC1) in colour, on the background where `inside` (CV_8UC1) is 0: CV_8UC3, BGR.
cv::Mat paint(const cv::Mat& samples, const cv::Mat& inside);

/// BGR.
cv::Scalar background();
cv::Scalar grid();
cv::Scalar label();

}  // namespace sonard::picture::amber
