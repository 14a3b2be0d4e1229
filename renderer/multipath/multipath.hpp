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

/// Does not depend on the engine. It traces rays only where something mirrors or sends sound on: a world
/// where nothing does needs no search trees.
class Multipath {
 public:
  /// @param index where the world is moved; it outlives this object.
  /// @param workers outlives this object.
  Multipath(SpatialIndex& index, WorkerPool& workers, const SkipSwitches& skip);

  /// Adds what arrives by way of other surfaces to an echo that is yet to be multiplied with spreading and
  /// absorption of every line (BinningResult::echo). Leaves out what the settings, SkipRule::multipath and
  /// SkipRule::bounces say.
  /// @param echo [beam * lines + line]
  /// @throws RendererError when Embree fails.
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
  void sum(const RangeLines& range, std::vector<float>& echo);

  const World& world_;  // of the index: bodies are where they were last moved to
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
