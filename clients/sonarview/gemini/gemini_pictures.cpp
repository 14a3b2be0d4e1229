// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/gemini_pictures.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "protocol/gemini/bearings.hpp"

namespace sonard::client {
namespace {

/// The samples as an OpenCV matrix, without a copy.
cv::Mat polar_of(const gemini::ReceivedPing& ping) {
  // OpenCV has no matrix of constant data; this one is only read.
  const bool eight_bit = !ping.samples.u8.empty();
  const void* data = eight_bit ? static_cast<const void*>(ping.samples.u8.data())
                               : static_cast<const void*>(ping.samples.u16.data());
  return {ping.lines, ping.head.beams, eight_bit ? CV_8UC1 : CV_16UC1, const_cast<void*>(data)};
}

std::string caption_of(const gemini::ReceivedPing& ping, double range_m) {
  return fmt::format("Gemini 720i  #{}   ping {}   {:.3f} s   {:.1f} m{}", ping.head.header.sonar_id,
                     ping.head.ping_id & 0xFF, static_cast<double>(ping.head.transmit_time_us) * 1e-6,
                     range_m, ping.complete() ? "" : fmt::format("   {} lines lost", ping.lines_lost));
}

}  // namespace

/// Used on the writer's thread only.
class GeminiPictures::Painter {
 public:
  Painter(const picture::FanStyle& style, double sound_speed_mps)
      : style_(style), sound_speed_mps_(sound_speed_mps) {}

  cv::Mat fan(const gemini::ReceivedPing& ping);

 private:
  picture::FanStyle style_;
  double sound_speed_mps_;
  std::optional<picture::FanImage> fan_;  ///< for the geometry of the last ping
};

cv::Mat GeminiPictures::Painter::fan(const gemini::ReceivedPing& ping) {
  picture::FanShape shape;
  shape.bearings_rad = gemini::bearings_rad(ping.head.beams);
  shape.lines = ping.lines;
  shape.line_step_m = sound_speed_mps_ / (2.0 * gemini::line_rate_hz) * (1 << ping.head.compression_log2());
  if (!fan_ || fan_->geometry().shape() != shape) {
    fan_.emplace(shape, style_);
  }
  const cv::Mat polar = polar_of(ping);
  cv::Mat eight_bit = polar;
  if (polar.type() != CV_8UC1) {
    polar.convertTo(eight_bit, CV_8UC1, 1.0 / 257.0);
  }
  return fan_->draw(eight_bit, caption_of(ping, shape.range_m()));
}

GeminiPictures::GeminiPictures(const picture::FanStyle& style, double sound_speed_mps)
    : painter_(std::make_shared<Painter>(style, sound_speed_mps)) {}

std::vector<Picture> GeminiPictures::of(gemini::ReceivedPing ping, const std::string& name) const {
  const auto shared = std::make_shared<const gemini::ReceivedPing>(std::move(ping));
  return {
      {fmt::format("fan-{}.png", name), [painter = painter_, shared] { return painter->fan(*shared); }},
      {fmt::format("polar-{}.png", name), [shared] { return picture::raw_polar_image(polar_of(*shared)); }}};
}

}  // namespace sonard::client
