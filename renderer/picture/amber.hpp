// SPDX-License-Identifier: Apache-2.0
// The colours of a sonar display: echoes glow from copper to amber to white on a night-blue ground.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace sonard::picture::amber {

/// What samples stand for. Amplitudes are shown by their square root, as displays stretch them: a bed and its
/// shadows are a tenth of what steel sends back.
enum class Samples { amplitudes, decibels };

/// BGR colour of each sample value: 1 x 256, CV_8UC3. Brightness rises with the value, so that a picture
/// reads the same in grey.
cv::Mat palette(Samples samples);

/// Samples (CV_8UC1) in colour, on the background where `inside` (CV_8UC1) is 0: CV_8UC3, BGR.
cv::Mat paint(const cv::Mat& values, Samples samples, const cv::Mat& inside);

/// BGR.
cv::Scalar background();
cv::Scalar grid();
cv::Scalar label();

}  // namespace sonard::picture::amber
