// SPDX-License-Identifier: Apache-2.0
#include "server/devices/render_load.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "renderer/sonar_settings.hpp"

namespace sonard::server {
namespace {

using Preset = render::Sampling::Preset;

constexpr std::chrono::seconds window_length{2};
constexpr double too_busy = 0.9;     // share of the time
constexpr double has_time = 0.6;     // share of the time, with the slower preset
constexpr double nearly_all = 0.95;  // of the requested pings
constexpr int fewest_pings = 3;      // fewer do not give a rate

double seconds_of(TimePoint duration) {
  return std::chrono::duration<double>(duration).count();
}

std::optional<Preset> faster_than(Preset preset) {
  switch (preset) {
    case Preset::reference:
      return Preset::normal;
    case Preset::normal:
      return Preset::fast;
    case Preset::fast:
    case Preset::grid:
      break;
  }
  return std::nullopt;
}

/// The next slower preset, at most `asked`.
Preset slower_than(Preset preset, Preset asked) {
  return preset == Preset::fast && asked != Preset::fast ? Preset::normal : asked;
}

std::string name_of(Preset preset) {
  return preset == Preset::fast ? "fast" : preset == Preset::normal ? "default" : "reference";
}

std::string advice_for(const render::SonarSettings& usual) {
  if (usual.directions.any()) {
    return "fewer directions (device.width, device.height), or a GPU";
  }
  std::string advice = "fewer range bins (a shorter range or more compression), ";
  if (usual.aperture.azimuth == render::Aperture::Azimuth::array && usual.aperture.fine_beams > 1) {
    advice += "acoustics.fine_beams: 1, ";
  }
  if (usual.model == render::Model::physical &&
      usual.physical.multipath.level != render::MultipathSettings::Level::off) {
    advice += "acoustics.physical.multipath.level: off, ";
  }
  return advice + "or a GPU";
}

}  // namespace

RenderLoad::RenderLoad(const render::SonarSettings& usual, bool adaptive)
    : asked_(usual.sampling.preset), preset_(asked_), adaptive_(adaptive), advice_(advice_for(usual)) {}

void RenderLoad::submitted(TimePoint now, std::chrono::nanoseconds period) {
  submitted_ = now;
  if (!window_) {
    window_ = Window{now};
  }
  window_->asked += period;
}

std::optional<Notice> RenderLoad::answered(TimePoint now) {
  if (!submitted_ || !window_) {
    return std::nullopt;
  }
  window_->waited += now - *submitted_;
  window_->pings += 1;
  submitted_.reset();
  if (now - window_->began < window_length || window_->pings < fewest_pings) {
    return std::nullopt;
  }
  const Window over = *std::exchange(window_, std::nullopt);
  const double length_s = seconds_of(now - over.began);
  return decide({.share = seconds_of(over.waited) / length_s,
                 .mean_ms = 1e3 * seconds_of(over.waited) / over.pings,
                 .pings_per_s = over.pings / length_s,
                 .asked_per_s = over.pings / seconds_of(over.asked)});
}

std::optional<Notice> RenderLoad::decide(const Load& load) {
  const auto changes_to = [&](Preset next, std::string_view back) {
    const Preset before = std::exchange(preset_, next);
    return Notice{
        Notice::Level::info,
        fmt::format(
            "rendering takes {:.0f} % of the time, {:.1f} ms per ping: sampling changes from {} {}to {}",
            100 * load.share, load.mean_ms, name_of(before), back, name_of(next))};
  };
  const std::optional<Preset> faster = faster_than(preset_);
  mean_ms_[static_cast<std::size_t>(preset_)] = load.mean_ms;
  if (load.share > too_busy && adaptive_ && faster) {
    return changes_to(*faster, "");
  }
  if (load.share > too_busy && load.pings_per_s < nearly_all * load.asked_per_s &&
      !std::exchange(told_, true)) {
    return Notice{
        Notice::Level::warning,
        fmt::format("the renderer is too slow: {:.1f} of {:.1f} requested pings per second, {:.0f} ms per "
                    "ping; try {}{}",
                    load.pings_per_s, load.asked_per_s, load.mean_ms,
                    faster ? "sampling.preset: fast or sampling.adaptive_quality: on, " : "", advice_)};
  }
  if (load.share < has_time) {
    told_ = false;
  }
  const Preset slower = slower_than(preset_, asked_);
  if (slower != preset_ && load.mean_ms > 0 &&
      load.share * mean_ms_[static_cast<std::size_t>(slower)] / load.mean_ms < has_time) {
    return changes_to(slower, "back ");
  }
  return std::nullopt;
}

}  // namespace sonard::server
