// SPDX-License-Identifier: Apache-2.0
// The pings of one head as a picture for people: a fan, or the newest turn of a scanning head.
#pragma once

#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "protocol/common/ping_record.hpp"
#include "renderer/picture/fan_image.hpp"
#include "renderer/picture/sweep_image.hpp"

namespace sonard::server {

/// Keeps what it takes to draw the next ping: the way from pixel to sample, and the lines of a turn. One
/// thread at a time.
class PingPicture {
 public:
  /// A line of a scanning head, for later pictures. Lines of another size begin anew.
  void keep(const PingRecord& line);
  /// A fan, or all lines that were kept, 400 pixels from the apex to the full range (CV_8UC3, BGR); empty
  /// where beams make no fan.
  cv::Mat draw(const PingRecord& ping);

 private:
  std::optional<picture::FanImage> fan_;
  std::map<int, picture::SweepLine> lines_;  ///< by bearing
  int bins_ = 0;
  double bin_m_ = 0.0;
};

}  // namespace sonard::server
