// SPDX-License-Identifier: Apache-2.0
// What a picture is of: a world, a sonar in it, and what is asked of the renderer.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::pictures {

/// One ping of a scanning head: where its transducer is turned to, and where the sonar is at that moment.
struct ScanLine {
  int bearing = 0;  ///< 1/16 gradian, 0..6399, as on a Micron's wire (protocol/micron/units.hpp)
  render::Pose T_world_sonar;
};

struct View {
  render::World world;
  render::Pose T_world_sonar;                          ///< of a fan
  std::optional<render::Pose> T_world_sonar_at_end{};  ///< of a fan that moves while it listens
  render::SonarSettings settings;
  double ray_curvature_per_m = 0.0;  ///< RendererOptions
  double display_scale = 1.0;        ///< ranges as a client shows them, over what they are
  std::vector<ScanLine> scan;        ///< of a scanning head, in steps of `scan_step`; empty: a fan
  int scan_step = 0;                 ///< 1/16 gradian
};

/// The first head of a configuration in configs/, as it pings at that range from where its vehicle is
/// `time_s` after the start (from the initial pose, or along the trajectory). A Gemini compresses two native
/// lines to one, an Oculus pings as it usually does, and a Micron makes one full turn in steps of 1.8 degrees
/// with 500 bins, `line_s` after each other. Reads meshes in child processes: call it before there are
/// threads.
/// @throws what loading a configuration, a world or a trajectory throws
View configured_view(const std::string& config, double range_m, double time_s = 0.0, double line_s = 0.05);

/// A sonar alone in a world of shapes: 256 beams of equal angle over 120 degrees, 20 degrees high, 1000 lines
/// to `range_m`; the settings are the defaults otherwise.
View plain_view(render::World world, const render::Pose& T_world_sonar, double range_m);

}  // namespace sonard::pictures
