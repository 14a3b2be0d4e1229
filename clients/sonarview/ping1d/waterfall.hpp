// SPDX-License-Identifier: Apache-2.0
// The profiles of the last pings, side by side, with the distance over them.
#pragma once

#include <cstddef>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <string>

#include "protocol/ping1d/client.hpp"

namespace sonard::client {

/// Draws pings in time to the right and range downwards, from 0 to the longest scan among them.
class Waterfall {
 public:
  /// @param height_px of the profiles, without the margin
  explicit Waterfall(int height_px) : height_px_(height_px) {}

  void add(const ping1d::ReceivedPing& ping);
  bool empty() const { return pings_.empty(); }

  /// In colour (CV_8UC3, BGR), with depth lines and a caption of the newest ping.
  cv::Mat draw() const;
  /// The samples (CV_8UC1): a column per ping, the newest at the right.
  cv::Mat samples() const;

 private:
  double range_mm() const;

  int height_px_;
  std::deque<ping1d::ReceivedPing> pings_;
};

/// "distance=2.000m confidence=98% ..."
std::string measurement_text(const ping1d::Distance& measured);

}  // namespace sonard::client
