// SPDX-License-Identifier: Apache-2.0
// Multipath: ghosts in smooth surfaces, corner reflectors and bounces between rough surfaces, added to the
// mean echo (docs/physics.md 2.11).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/multipath/bounces.hpp"
#include "renderer/multipath/corner_reflectors.hpp"
#include "renderer/multipath/ghost_paths.hpp"
#include "renderer/multipath/mirror_survey.hpp"
#include "renderer/multipath/path_fan.hpp"
#include "renderer/multipath/path_scene.hpp"
#include "renderer/pose.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Adds multipath, independently of the engine. It traces rays only if something mirrors or sends sound on; a
/// world in which nothing does needs no search trees.
class Multipath {
 public:
  /// @param index moves the world; must outlive this object
  /// @param workers must outlive this object
  Multipath(SpatialIndex& index, WorkerPool& workers, const SkipSwitches& skip);

  /// Adds multipath to an echo before spreading and absorption (BinningResult::echo). Settings,
  /// SkipRule::multipath and SkipRule::bounces can switch parts off.
  /// @param echo [beam * lines + line]
  /// @throws RendererError if Embree fails
  void add_to(std::vector<float>& echo, const SonarSettings& settings, const Pose& T_world_sonar,
              SkipCounts& skipped);

 private:
  bool is_needed(const MultipathSettings& settings, double max_range_m, const Pose& T_world_sonar) const;
  void prepare(const SonarSettings& settings);
  void collect(const SonarSettings& settings, const Pose& T_world_sonar, const PathLimits& limits);
  void collect_bounces(const SonarSettings& settings, const Pose& T_world_sonar, const PathLimits& limits);
  GhostPaths::Result search_small_parts(const Pose& T_world_sonar, const PathLimits& limits) const;
  void collect_corners(const std::vector<CornerCandidate>& corners, const SonarSettings& settings,
                       const Pose& T_world_sonar, const PathLimits& limits);
  void sum(const RangeBins& range, std::vector<float>& echo);

  const World& world_;  // of the index, with bodies at their last poses
  WorkerPool& workers_;
  const SkipSwitches skip_;
  MirrorSurvey survey_;
  PathScene scene_;
  std::unique_ptr<PathFan> fan_;
  GhostPaths ghosts_;
  Bounces bounces_;
  std::vector<std::vector<EchoPatch>> patches_of_beam_;
};

}  // namespace sonard::render
