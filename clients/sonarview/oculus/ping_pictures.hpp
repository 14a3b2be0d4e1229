// SPDX-License-Identifier: Apache-2.0
// The pictures of a ping of an Oculus.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "protocol/oculus/host.hpp"
#include "renderer/picture/fan_image.hpp"

namespace sonard::client {

/// Makes them for one ImageWriter, on whose thread they are drawn. Pings mostly have one shape, so the way
/// from pixel to sample is kept from one to the next.
class OculusPictures {
 public:
  explicit OculusPictures(const picture::FanStyle& style);

  /// The files fan-<name>.png, without the gamma of the samples, and polar-<name>.png, as they came.
  std::vector<Picture> of(oculus::ReceivedPing ping, const std::string& name) const;

 private:
  class Painter;
  std::shared_ptr<Painter> painter_;
};

}  // namespace sonard::client
