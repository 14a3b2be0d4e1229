// SPDX-License-Identifier: Apache-2.0
// Echoes by way of several rough surfaces: the halo behind a structure, the tail behind the walls of a basin
// (docs/physics.md 2.11).
#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/multipath/ghost_paths.hpp"
#include "renderer/multipath/mirror_survey.hpp"
#include "renderer/multipath/path_scene.hpp"
#include "renderer/multipath_settings.hpp"
#include "renderer/pose.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Least share of the incident power, R^2 + pi mu, that a surface must send on to be followed: -15 dB.
inline constexpr double least_sent_on = 0.0316227766016838;

/// Follows random paths, one for every few square degrees of the fan. The random numbers depend on the fan's
/// cells alone: a repeated ping has the same paths, for any number of threads.
class Bounces {
 public:
  /// @param world its bodies may move; their meshes and materials must not change.
  Bounces(const World& world, WorkerPool& workers);

  /// True if a part in range sends sound on (SkipRule::bounces).
  bool any_in_range(const World& world, const glm::dvec3& sonar_position_m, double max_range_m) const;

  /// @return the echoes of every group of paths, groups from port to starboard; valid until the next call.
  const std::vector<std::vector<BeamPatch>>& follow(const PathScene& scene, const PathFan& fan,
                                                    const Pose& T_world_sonar, const PathLimits& limits,
                                                    const MultipathSettings& settings);

 private:
  struct Part {
    std::size_t body = 0, part = 0;
    MirrorSurvey::Ball ball;  ///< in the frame of the part
  };

  std::vector<Part> parts_;  // parts that send sound on
  WorkerPool& workers_;
  std::vector<std::vector<BeamPatch>> results_;
};

}  // namespace sonard::render
