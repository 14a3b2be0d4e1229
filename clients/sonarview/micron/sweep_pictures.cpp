// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/micron/sweep_pictures.hpp"

#include <fmt/format.h>

#include <utility>

#include "protocol/micron/units.hpp"

namespace sonard::client {
namespace {

picture::SweepShape shape_of(const micron::ScanSettings& settings) {
  picture::SweepShape shape;
  if (settings.sector) {
    shape.left = settings.sector->left;
    shape.width = micron::wrapped(settings.sector->right - settings.sector->left);
  }
  shape.step = settings.step;
  shape.bins = settings.bins;
  shape.bin_m = micron::bin_length_m(settings);
  return shape;
}

std::string caption_of(const Sweep& sweep, const picture::SweepShape& shape) {
  return fmt::format("Micron   turn {}   {} lines   {:.1f} m{}", sweep.number, sweep.lines.size(),
                     shape.range_m(),
                     sweep.lines_missed == 0 ? "" : fmt::format("   {} lines lost", sweep.lines_missed));
}

}  // namespace

SweepPictures::SweepPictures(const micron::ScanSettings& settings, const picture::FanStyle& style)
    : shape_(shape_of(settings)),
      sector_(settings.sector.has_value()),
      scale_(settings.eight_bit ? 1 : 17),
      image_(std::make_shared<picture::SweepImage>(shape_, style)) {}

std::vector<Picture> SweepPictures::of(const Sweep& sweep, const std::vector<std::string>& names) const {
  std::vector<picture::SweepLine> lines;
  lines.reserve(sweep.lines.size());
  for (const micron::ReceivedLine& received : sweep.lines) {
    picture::SweepLine line{received.head.bearing, received.bins};
    for (std::uint8_t& sample : line.samples) {
      sample = static_cast<std::uint8_t>(sample * scale_);
    }
    lines.push_back(std::move(line));
  }
  const auto shared = std::make_shared<const std::vector<picture::SweepLine>>(std::move(lines));
  std::vector<Picture> pictures;
  for (const std::string& name : names) {
    pictures.push_back({fmt::format("{}-{}.png", sector_ ? "fan" : "turn", name),
                        [image = image_, shared, caption = caption_of(sweep, shape_)] {
                          return image->draw(*shared, caption);
                        }});
    pictures.push_back({fmt::format("polar-{}.png", name),
                        [shape = shape_, shared] { return picture::sweep_polar_image(shape, *shared); }});
  }
  return pictures;
}

}  // namespace sonard::client
