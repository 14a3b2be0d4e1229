// SPDX-License-Identifier: Apache-2.0
// Whether a head gets its images as fast as its client asks for pings, and what is done about it.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string>

#include "protocol/common/device.hpp"
#include "renderer/sonar_settings.hpp"
#include "server/clock/clock.hpp"

namespace sonard::server {

/// Looks, every two seconds, at the share of the time in which a head waited for an image. A head that waits
/// nearly always would ping more often if it could: where quality adapts, its preset gives way to the next
/// faster one, and comes back when there is time for it; else the operator is warned once that fewer pings
/// are made than were asked for. Belongs to the thread of its head.
class RenderLoad {
 public:
  /// @param configured of the head. Its preset is never exceeded; Preset::grid has no faster one. The
  /// operator is advised to give up what it has on.
  RenderLoad(const render::SonarSettings& configured, bool adaptive);

  /// The preset of the next ping.
  render::Sampling::Preset preset() const { return preset_; }

  /// @param period PingJob::period
  void submitted(TimePoint now, std::chrono::nanoseconds period);
  /// The image is there, or could not be made.
  /// @return what the operator is to know
  std::optional<Notice> answered(TimePoint now);
  /// It was taken back before it was rendered, and says nothing of the load.
  void withdrawn() { submitted_.reset(); }

 private:
  struct Window {
    TimePoint began{}, waited{};
    std::chrono::nanoseconds asked{};  ///< periods of all pings
    int pings = 0;
  };
  /// What a window has shown.
  struct Load {
    double share = 0.0;  ///< of the time in which the head waited
    double mean_ms = 0.0;
    double pings_per_s = 0.0;
    double asked_per_s = 0.0;
  };

  std::optional<Notice> decide(const Load& load);

  render::Sampling::Preset asked_, preset_;
  bool adaptive_;
  std::string advice_;  ///< what else makes it faster
  bool told_ = false;
  std::optional<TimePoint> submitted_;
  std::optional<Window> window_;
  std::array<double, 4> mean_ms_{};  ///< of a ping, by preset, of the last window that had it
};

}  // namespace sonard::server
