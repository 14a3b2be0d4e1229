// SPDX-License-Identifier: Apache-2.0
// The colours of a sonar display: copper, amber and white echoes on a night-blue background.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace sonard::picture::amber {

/// The unit of samples. Amplitudes are displayed by their square root, because a seabed and its shadows have
/// a tenth of the amplitude of steel.
enum class Samples { amplitudes, decibels };

/// BGR colour of each sample value: 1 x 256, CV_8UC3. Brightness rises with the value, so that a grey copy of
/// the picture stays readable.
cv::Mat palette(Samples samples);

/// Draws samples (CV_8UC1) in colour, with the background if `inside` (CV_8UC1) is 0: CV_8UC3, BGR.
cv::Mat paint(const cv::Mat& values, Samples samples, const cv::Mat& inside);

/// BGR.
cv::Scalar background();
cv::Scalar grid();
cv::Scalar label();

}  // namespace sonard::picture::amber
