// SPDX-License-Identifier: Apache-2.0
// Why frames of a run are black, counted.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"
#include "server/diagnosis/sight.hpp"
#include "server/offline/frame_source.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// Looks around from the place of frames, as `sonard check` does from the initial pose. It renders nothing.
class FrameFindings {
 public:
  /// All references must outlive this object. @param world without the parts of a hidden vehicle
  FrameFindings(const render::World& world, const DaemonConfig& config, std::size_t head,
                const VehicleTrajectory& trajectory);

  /// True if this frame is one to look at. In a world of many triangles only every k-th is, because a look
  /// takes up to ten nanoseconds per triangle.
  bool wants(int frame) const { return frame % every_ == 0; }
  void add(const std::string& frame, const FrameView& view);

  /// One line per cause, the most frequent first: "12 of 40 frames: The sonar is ... (first in ping_000003)".
  std::vector<std::string> lines() const;

 private:
  struct Cause {
    std::string code, text, first_frame;
    int frames = 0;
  };

  const render::World& world_;
  const DaemonConfig& config_;
  const HeadConfig& head_;
  const VehicleTrajectory& trajectory_;
  std::vector<BodyBox> boxes_;
  int every_ = 1;
  int frames_ = 0;
  std::vector<Cause> causes_;
};

}  // namespace sonard::server
