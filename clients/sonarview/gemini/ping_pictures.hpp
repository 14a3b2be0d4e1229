// SPDX-License-Identifier: Apache-2.0
// The pictures of a ping.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "protocol/gemini/topside.hpp"
#include "renderer/picture/fan_image.hpp"

namespace sonard::client {

/// Makes them for one ImageWriter, on whose thread they are drawn: pings mostly have one shape, so the way
/// from pixel to sample is kept from one to the next.
class PingPictures {
 public:
  /// `sound_speed_mps`: in which the user counts ranges.
  PingPictures(const picture::FanStyle& style, double sound_speed_mps);

  /// The files fan-<name>.png and polar-<name>.png.
  std::vector<Picture> of(gemini::ReceivedPing ping, const std::string& name) const;

 private:
  class Painter;
  std::shared_ptr<Painter> painter_;
};

}  // namespace sonard::client
