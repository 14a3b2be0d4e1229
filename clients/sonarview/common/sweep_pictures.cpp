// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/sweep_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

namespace sonard::client {

Sweep with_lines_before(Sweep sweep, const std::optional<Sweep>& before) {
  std::set<int> bearings;
  for (const picture::SweepLine& line : sweep.lines) {
    bearings.insert(line.bearing);
  }
  std::vector<picture::SweepLine> older;
  if (before) {
    std::copy_if(before->lines.begin(), before->lines.end(), std::back_inserter(older),
                 [&](const picture::SweepLine& line) { return bearings.count(line.bearing) == 0; });
  }
  sweep.lines.insert(sweep.lines.begin(), older.begin(), older.end());
  return sweep;
}

SweepPictures::SweepPictures(SweepForm form, std::uint64_t every)
    : form_(std::move(form)),
      every_(every),
      image_(std::make_shared<picture::SweepImage>(form_.shape,
                                                   picture::FanStyle{.radius_px = form_.radius_px})) {}

std::vector<Picture> SweepPictures::of(const Sweep& sweep, const std::vector<std::string>& names) const {
  auto lines = std::make_shared<std::vector<picture::SweepLine>>(sweep.lines);
  for (picture::SweepLine& line : *lines) {
    for (std::uint8_t& sample : line.samples) {
      sample = static_cast<std::uint8_t>(sample * form_.scale);
    }
  }
  const std::string caption = fmt::format(
      "{}   turn {}   {} {}   {:.1f} m{}", form_.title, sweep.number, sweep.lines.size(), form_.lines,
      form_.shape.range_m(),
      sweep.lines_missed == 0 ? "" : fmt::format("   {} {} lost", sweep.lines_missed, form_.lines));
  std::vector<Picture> pictures;
  for (const std::string& name : names) {
    pictures.push_back({fmt::format("{}-{}.png", form_.sector ? "fan" : "turn", name),
                        [image = image_, lines, caption] { return image->draw(*lines, caption); }});
    pictures.push_back({fmt::format("polar-{}.png", name),
                        [shape = form_.shape, lines] { return picture::sweep_polar_image(shape, *lines); }});
  }
  return pictures;
}

void SweepPictures::write(ImageWriter& writer, const Sweep& sweep) {
  std::vector<std::string> names{"last"};
  if (every_ > 0 && sweep.number % every_ == 0) {
    names.push_back(fmt::format("{:06}", sweep.number));
  }
  writer.write(of(sweep, names));
  last_ = sweep;
}

void SweepPictures::refresh(ImageWriter& writer, const Sweep& current) const {
  if (!current.lines.empty()) {
    writer.refresh(of(with_lines_before(current, last_), {"last"}));
  }
}

void SweepPictures::finish(ImageWriter& writer, const Sweep& current) const {
  if (!last_ && !current.lines.empty()) {
    writer.write(of(current, {"last"}));
  }
}

}  // namespace sonard::client
