// SPDX-License-Identifier: Apache-2.0
// Draws the pings of one head: a fan, or the newest turn of a scanning head.
#pragma once

#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "protocol/common/ping_record.hpp"
#include "renderer/picture/fan_image.hpp"
#include "renderer/picture/sweep_image.hpp"

namespace sonard::server {

/// Keeps data to draw the next ping: the map from pixel to sample, and the lines of a turn. One thread at a
/// time.
class PingPicture {
 public:
  /// Keeps a line of a scanning head for later pictures. A line of another size drops the earlier ones.
  void keep(const PingRecord& line);
  /// Draws a fan, or all kept lines, 400 pixels from the apex to the full range (CV_8UC3, BGR). Empty if the
  /// beams do not form a fan.
  cv::Mat draw(const PingRecord& ping);

 private:
  std::optional<picture::FanImage> fan_;
  std::map<int, picture::SweepLine> lines_;  ///< by bearing
  int bins_ = 0;
  double bin_m_ = 0.0;
};

}  // namespace sonard::server
