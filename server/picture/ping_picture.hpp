// SPDX-License-Identifier: Apache-2.0
// The pings of one head as a picture for people: a fan, or the newest turn of a scanning head.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "renderer/picture/fan_image.hpp"
#include "renderer/picture/sweep_image.hpp"
#include "server/devices/ping_viewer.hpp"

namespace sonard::server {

/// Keeps what it takes to draw the next ping: the way from pixel to sample, and the lines of a turn. One
/// thread at a time.
class PingPicture {
 public:
  /// A line of a scanning head, for later pictures. Lines of another size begin anew.
  void keep(const ShownPing& line);
  /// PNG of a fan, or of all lines that were kept, 400 pixels from the apex to the full range; "" where beams
  /// make no fan.
  std::string png(const ShownPing& ping);

 private:
  std::optional<picture::FanImage> fan_;
  std::map<int, picture::SweepLine> lines_;  ///< by bearing
  int bins_ = 0;
  double bin_m_ = 0.0;
};

}  // namespace sonard::server
