// SPDX-License-Identifier: Apache-2.0
// The pictures of a ping.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "protocol/gemini/client.hpp"
#include "renderer/picture/fan_image.hpp"

namespace sonard::client {

/// Makes the pictures for one ImageWriter, whose thread draws them. Pings mostly have the same geometry, so
/// the map from pixel to sample is reused.
class GeminiPictures {
 public:
  /// @param sound_speed_mps sound speed of the ranges that the user set
  GeminiPictures(const picture::FanStyle& style, double sound_speed_mps);

  /// The files fan-<name>.png and polar-<name>.png.
  std::vector<Picture> of(gemini::ReceivedPing ping, const std::string& name) const;

 private:
  class Painter;
  std::shared_ptr<Painter> painter_;
};

}  // namespace sonard::client
