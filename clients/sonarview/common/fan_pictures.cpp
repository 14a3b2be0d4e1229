// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/fan_pictures.hpp"

#include <fmt/format.h>

#include <utility>

#include "protocol/common/linear_samples.hpp"

namespace sonard::client {
namespace {

cv::Mat draw(std::optional<picture::FanImage>& image, const picture::FanStyle& style, const FanPing& ping) {
  if (!image || image->geometry().shape() != ping.shape) {
    image.emplace(ping.shape, style);
  }
  cv::Mat linear;
  ping.samples.convertTo(linear, CV_8UC1, ping.samples.type() == CV_8UC1 ? 1.0 : 1.0 / 257.0);
  make_linear({linear.data, linear.total()}, ping.amplitude_exponent);
  return image->draw(linear, ping.caption);
}

}  // namespace

std::vector<Picture> FanPictures::last_as(const std::string& name) const {
  return {{fmt::format("fan-{}.png", name),
           [image = image_, style = style_, ping = *last_] { return draw(*image, style, ping); }},
          {fmt::format("polar-{}.png", name),
           [samples = last_->samples] { return picture::raw_polar_image(samples); }}};
}

void FanPictures::take(ImageWriter& writer, FanPing ping, std::uint64_t number) {
  last_ = std::move(ping);
  last_is_shown_ = false;
  if (every_ > 0 && number % every_ == 0) {
    writer.write(last_as(fmt::format("{:06}", number)));
  }
}

void FanPictures::refresh(ImageWriter& writer) {
  if (!std::exchange(last_is_shown_, true)) {
    writer.refresh(last_as("last"));
  }
}

void FanPictures::finish(ImageWriter& writer) const {
  if (last_) {
    writer.write(last_as("last"));
  }
}

}  // namespace sonard::client
