// SPDX-License-Identifier: Apache-2.0
// The contents of a picture: a world, a sonar in it, and the settings of the renderer.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::pictures {

/// One ping of a scanning head: the bearing of its transducer and the pose of the sonar at that time.
struct ScanLine {
  int bearing = 0;  ///< 1/16 gradian, 0..6399, as on a Micron's wire (protocol/micron/units.hpp)
  render::Pose T_world_sonar;
};

struct View {
  render::World world;
  render::Pose T_world_sonar;                          ///< for a fan
  std::optional<render::Pose> T_world_sonar_at_end{};  ///< for a fan that moves during the ping
  render::SonarSettings settings;
  double ray_curvature_per_m = 0.0;  ///< RendererOptions
  double display_scale = 1.0;        ///< displayed range over true range
  std::vector<ScanLine> scan;        ///< for a scanning head, in steps of `scan_step`; empty: a fan
  int scan_step = 0;                 ///< 1/16 gradian
};

/// The view of the first head of a configuration in configs/, with this range. The vehicle is at its place
/// `time_s` after the start (at the initial pose or on the trajectory). A Gemini averages two range bins into
/// one, an Oculus makes its usual ping, and a Micron makes a full turn in steps of 1.8 degrees with 500 bins,
/// one line every `line_s`. Reads meshes in child processes: call it before threads exist.
/// @throws the exceptions of loading a configuration, a world or a trajectory
View configured_view(const std::string& config, double range_m, double time_s = 0.0, double line_s = 0.05);

/// Poses of the first head of a configuration (T_world_sonar) while its vehicle follows a trajectory, both in
/// configs/, at these times after the start.
/// @throws the exceptions of loading a configuration or a trajectory
std::vector<render::Pose> poses_along(const std::string& config, const std::string& trajectory,
                                      const std::vector<double>& times_s);

/// A sonar in a world of shapes: 256 beams of equal angle over 120 degrees, 20 degrees high, 1000 lines up to
/// `range_m`, otherwise default settings.
View plain_view(render::World world, const render::Pose& T_world_sonar, double range_m);

}  // namespace sonard::pictures
