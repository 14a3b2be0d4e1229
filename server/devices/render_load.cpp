// SPDX-License-Identifier: Apache-2.0
#include "server/devices/render_load.hpp"

#include <cstddef>

#include <fmt/format.h>

namespace sonard::server {
namespace {

using Preset = render::Sampling::Preset;

constexpr std::chrono::seconds window_length{2};
constexpr double too_busy = 0.9;  // share of the time
constexpr double has_time = 0.6;  // which the slower preset would take up
constexpr int fewest_pings = 3;   // fewer say nothing of a rate

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

/// At most the one that was asked for.
Preset slower_than(Preset preset, Preset asked) {
  return preset == Preset::fast && asked != Preset::fast ? Preset::normal : asked;
}

std::string name_of(Preset preset) {
  return preset == Preset::fast ? "fast" : preset == Preset::normal ? "default" : "reference";
}

}  // namespace

RenderLoad::RenderLoad(Preset asked, bool adaptive) : asked_(asked), preset_(asked), adaptive_(adaptive) {}

void RenderLoad::submitted(TimePoint now) {
  submitted_ = now;
  if (!window_) {
    window_ = Window{now};
  }
}

std::string RenderLoad::answered(TimePoint now) {
  if (!submitted_ || !window_) {
    return "";
  }
  window_->waited += now - *submitted_;
  window_->pings += 1;
  submitted_.reset();
  const double length_s = seconds_of(now - window_->began);
  if (now - window_->began < window_length || window_->pings < fewest_pings) {
    return "";
  }
  const double waited_s = seconds_of(window_->waited);
  const int pings = window_->pings;
  window_.reset();
  return decide(waited_s / length_s, 1e3 * waited_s / pings, pings / length_s);
}

std::string RenderLoad::decide(double share, double mean_ms, double pings_per_s) {
  const std::string busy =
      fmt::format("{:.0f} % of the time goes into rendering, {:.1f} ms a ping, {:.1f} pings a second",
                  100 * share, mean_ms, pings_per_s);
  const Preset before = preset_;
  mean_ms_[static_cast<std::size_t>(before)] = mean_ms;
  const std::optional<Preset> faster = faster_than(before);
  if (share > too_busy && adaptive_ && faster) {
    preset_ = *faster;
    return fmt::format("{}: sampling goes from {} to {}", busy, name_of(before), name_of(preset_));
  }
  if (share > too_busy && !told_) {
    told_ = true;
    return fmt::format(
        "{}: a client that asks for more does not get it. Fewer range bins (a shorter range, or more "
        "compression) cost less, and so do: {}acoustics.fine_beams: 1, acoustics.multipath: off, a GPU",
        busy, faster ? "sampling.preset: fast, or sampling.adaptive_quality: on; " : "");
  }
  if (share < has_time) {
    told_ = false;
  }
  const Preset slower = slower_than(before, asked_);
  if (slower != before && mean_ms > 0 &&
      share * mean_ms_[static_cast<std::size_t>(slower)] / mean_ms < has_time) {
    preset_ = slower;
    return fmt::format("{}: sampling goes from {} back to {}", busy, name_of(before), name_of(preset_));
  }
  return "";
}

}  // namespace sonard::server
