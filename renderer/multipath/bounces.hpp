// SPDX-License-Identifier: Apache-2.0
// Echoes by way of several rough surfaces: the halo that a structure trails, the tail behind the walls of a
// basin (docs/physics.md 2.11).
#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/multipath/ghost_paths.hpp"
#include "renderer/multipath/mirror_survey.hpp"
#include "renderer/multipath/path_scene.hpp"
#include "renderer/pose.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Surfaces that send on less of the sound they meet than this, R^2 + pi mu, send none: -15 dB.
inline constexpr double least_sent_on = 0.0316227766016838;

/// Follows paths that are drawn at random, one for every few square degrees of the fan. The numbers are those
/// of the fan's cells: a ping that is asked for again has the same paths, whatever the number of threads.
class Bounces {
 public:
  /// @param world its bodies may move; what they are made of stays.
  Bounces(const World& world, WorkerPool& workers);

  /// Whether a part in range sends sound on (SkipRule::bounces).
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

  std::vector<Part> parts_;  // those that send sound on
  WorkerPool& workers_;
  std::vector<std::vector<BeamPatch>> results_;
};

}  // namespace sonard::render
