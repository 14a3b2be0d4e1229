// SPDX-License-Identifier: Apache-2.0
// The pictures of a ping of an Oculus.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "protocol/oculus/client.hpp"
#include "renderer/picture/fan_image.hpp"

namespace sonard::client {

/// Makes the pictures for one ImageWriter, whose thread draws them. Pings mostly have the same geometry, so
/// the map from pixel to sample is reused.
class OculusPictures {
 public:
  explicit OculusPictures(const picture::FanStyle& style);

  /// The files fan-<name>.png with linear samples (without gamma) and polar-<name>.png with samples as
  /// received.
  std::vector<Picture> of(oculus::ReceivedPing ping, const std::string& name) const;

 private:
  class Painter;
  std::shared_ptr<Painter> painter_;
};

}  // namespace sonard::client
