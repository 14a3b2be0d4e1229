// SPDX-License-Identifier: Apache-2.0
#include "server/picture/ping_picture.hpp"

#include <algorithm>
#include <functional>
#include <vector>

#include "protocol/common/linear_samples.hpp"

namespace sonard::server {
namespace {

constexpr picture::FanStyle style{.radius_px = 400, .grid = true};
constexpr double quarter_turn_rad = 1.5707963267948966;

bool make_a_fan(const std::vector<double>& bearings_rad) {
  return bearings_rad.size() >= 2 &&
         std::ranges::adjacent_find(bearings_rad, std::ranges::greater_equal{}) == bearings_rad.end() &&
         bearings_rad.front() > -quarter_turn_rad && bearings_rad.back() < quarter_turn_rad;
}

/// The most frequent bearing step between neighbours; 32 if there are fewer than two lines.
int step_of(const std::map<int, picture::SweepLine>& lines) {
  std::map<int, int> counts;
  for (auto line = lines.begin(); line != lines.end() && std::next(line) != lines.end(); ++line) {
    ++counts[std::next(line)->first - line->first];
  }
  const auto most = std::ranges::max_element(counts, {}, [](const auto& count) { return count.second; });
  return counts.empty() ? 32 : std::clamp(most->first, 1, 255);
}

}  // namespace

void PingPicture::keep(const PingRecord& line) {
  const RecordedSettings& settings = line.settings;
  if (settings.bins != bins_ || settings.bin_m != bin_m_) {
    lines_.clear();
    bins_ = settings.bins;
    bin_m_ = settings.bin_m;
  }
  const int bearing = picture::turn_bearing(line.bearings_rad.front());
  lines_[bearing] = {bearing, line.samples};
}

cv::Mat PingPicture::draw(const PingRecord& ping) {
  const RecordedSettings& settings = ping.settings;
  if (settings.beams == 1) {
    std::vector<picture::SweepLine> lines;
    for (const auto& [bearing, line] : lines_) {
      lines.push_back(line);
    }
    const picture::SweepShape shape{.step = step_of(lines_), .bins = bins_, .bin_m = bin_m_};
    return picture::SweepImage(shape, style).draw(lines, "");
  }
  const picture::FanShape shape{ping.bearings_rad, settings.bins, settings.bin_m};
  if (!make_a_fan(shape.bearings_rad)) {
    return {};
  }
  if (!fan_ || fan_->geometry().shape() != shape) {
    fan_.emplace(shape, style);
  }
  std::vector<std::uint8_t> samples = ping.samples;
  make_linear(samples, settings.amplitude_exponent);
  return fan_->draw(cv::Mat(settings.bins, settings.beams, CV_8UC1, samples.data()), "");
}

}  // namespace sonard::server
