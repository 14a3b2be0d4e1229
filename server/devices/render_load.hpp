// SPDX-License-Identifier: Apache-2.0
// Whether a head gets its images as fast as its client asks for pings, and what is done about it.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string>

#include "renderer/sonar_settings.hpp"
#include "server/clock/clock.hpp"

namespace sonard::server {

/// Looks, every two seconds, at the share of the time in which a head waited for an image. A head that waits
/// nearly always would ping more often if it could: where quality adapts, its preset gives way to the next
/// faster one, and comes back when there is time for it; else the operator is told once. Belongs to the
/// thread of its head.
class RenderLoad {
 public:
  /// @param asked the preset of the configuration, which is never exceeded; Preset::grid has no faster one
  RenderLoad(render::Sampling::Preset asked, bool adaptive);

  /// The preset of the next ping.
  render::Sampling::Preset preset() const { return preset_; }

  void submitted(TimePoint now);
  /// The image is there, or could not be made.
  /// @return what the operator is to know; empty: nothing new
  std::string answered(TimePoint now);
  /// It was taken back before it was rendered, and says nothing of the load.
  void withdrawn() { submitted_.reset(); }

 private:
  struct Window {
    TimePoint began{}, waited{};
    int pings = 0;
  };

  std::string decide(double share, double mean_ms, double pings_per_s);

  render::Sampling::Preset asked_, preset_;
  bool adaptive_;
  bool told_ = false;
  std::optional<TimePoint> submitted_;
  std::optional<Window> window_;
  std::array<double, 4> mean_ms_{};  ///< of a ping, by preset, of the last window that had it
};

}  // namespace sonard::server
