// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/oculus/oculus_pictures.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <numbers>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "protocol/common/linear_samples.hpp"
#include "protocol/oculus/image_form.hpp"

namespace sonard::client {
namespace {

/// @param exponent gamma exponent of the samples, which are made linear; 1: samples stay unchanged
cv::Mat polar_of(const oculus::PingResult& ping, double exponent = 1.0) {
  std::vector<std::uint8_t> samples = oculus::eight_bit_samples(ping);
  make_linear(samples, exponent);
  return cv::Mat(ping.ranges, ping.beams, CV_8UC1, samples.data()).clone();
}

picture::FanShape shape_of(const oculus::PingResult& ping) {
  picture::FanShape shape;
  for (const std::int16_t bearing : ping.bearings_cdeg) {
    shape.bearings_rad.push_back(bearing * std::numbers::pi / 18000.0);
  }
  shape.lines = ping.ranges;
  shape.line_step_m = ping.range_resolution_m;
  return shape;
}

}  // namespace

/// Used on the writer's thread only.
class OculusPictures::Painter {
 public:
  explicit Painter(const picture::FanStyle& style) : style_(style) {}

  cv::Mat fan(const oculus::PingResult& ping) {
    const picture::FanShape shape = shape_of(ping);
    if (!fan_ || fan_->geometry().shape() != shape) {
      fan_.emplace(shape, style_);
    }
    const std::string caption =
        fmt::format("Oculus  {:.0f} kHz   ping {}   {} beams   {:.1f} m", ping.frequency_hz * 1e-3,
                    ping.ping_id, ping.beams, shape.range_m());
    return fan_->draw(polar_of(ping, oculus::gamma_exponent(ping.fire.fire.gamma)), caption);
  }

 private:
  picture::FanStyle style_;
  std::optional<picture::FanImage> fan_;  ///< for the geometry of the last ping
};

OculusPictures::OculusPictures(const picture::FanStyle& style) : painter_(std::make_shared<Painter>(style)) {}

std::vector<Picture> OculusPictures::of(oculus::ReceivedPing ping, const std::string& name) const {
  const auto shared = std::make_shared<const oculus::ReceivedPing>(std::move(ping));
  return {{fmt::format("fan-{}.png", name),
           [painter = painter_, shared] { return painter->fan(shared->result); }},
          {fmt::format("polar-{}.png", name),
           [shared] { return picture::raw_polar_image(polar_of(shared->result)); }}};
}

}  // namespace sonard::client
