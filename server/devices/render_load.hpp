// SPDX-License-Identifier: Apache-2.0
// Tests whether a head's images arrive as fast as its client requests pings, and adapts the quality.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string>

#include "protocol/common/device.hpp"
#include "renderer/sampling.hpp"
#include "server/clock/clock.hpp"

namespace sonard::render {
struct SonarSettings;
}

namespace sonard::server {

/// Measures, about every two seconds, the share of time in which a head waited for an image. If it waits
/// nearly always and quality is adaptive, the preset changes to the next faster one, and back when there is
/// time. Else the operator is warned once that fewer pings are made than requested. Belongs to the head's
/// thread.
class RenderLoad {
 public:
  /// @param usual settings of the head's usual ping: their preset is the upper limit; Preset::grid has no
  /// faster one. The warning suggests settings that such a ping has and that can be turned off.
  RenderLoad(const render::SonarSettings& usual, bool adaptive);

  /// The preset of the next ping.
  render::Sampling::Preset preset() const { return preset_; }

  /// @param period PingJob::period
  void submitted(TimePoint now, std::chrono::nanoseconds period);
  /// Called when the image has arrived or is impossible.
  /// @return a message for the operator
  std::optional<Notice> answered(TimePoint now);
  /// Called if the ping was withdrawn before rendering; it does not count.
  void withdrawn() { submitted_.reset(); }

 private:
  struct Window {
    TimePoint began{}, waited{};
    std::chrono::nanoseconds asked{};  ///< sum of the periods of all pings
    int pings = 0;
  };
  /// Result of a window.
  struct Load {
    double share = 0.0;  ///< of the time, waited for images
    double mean_ms = 0.0;
    double pings_per_s = 0.0;
    double asked_per_s = 0.0;
  };

  std::optional<Notice> decide(const Load& load);

  render::Sampling::Preset asked_, preset_;
  bool adaptive_;
  std::string advice_;  ///< other ways to make it faster
  bool told_ = false;
  std::optional<TimePoint> submitted_;
  std::optional<Window> window_;
  std::array<double, 4> mean_ms_{};  ///< of a ping, by preset, from the last window that used it
};

}  // namespace sonard::server
