// The colours of a sonar display: echoes glow from copper to amber to white on a night-blue ground.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace sonard::client::amber {

/// BGR colour of each sample value: 1 x 256, CV_8UC3. Brightness rises strictly with the value, so that a
/// picture reads the same in grey.
cv::Mat palette();

/// BGR.
cv::Scalar background();
cv::Scalar grid();
cv::Scalar label();

}  // namespace sonard::client::amber
