// Multipath: ghosts in smooth surfaces and glints of corners, added to the mean echo (docs/physics.md 2.11).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/multipath/corner_glints.hpp"
#include "renderer/multipath/ghost_paths.hpp"
#include "renderer/multipath/mirror_survey.hpp"
#include "renderer/multipath/path_fan.hpp"
#include "renderer/multipath/path_scene.hpp"
#include "renderer/pose.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// The same on every backend. What it traces rays in is built when a ping first needs it: a world without
/// mirrors never pays for it.
class Multipath {
 public:
  Multipath(const World& world, WorkerPool& workers, const SkipSwitches& skip);

  /// As those of Sampler.
  void set_body_pose(std::size_t body, const Pose& T_world_body);
  void set_part_meshes(std::span<const PartMesh> changes);

  /// Adds what arrives by mirrors to an echo that is yet to be multiplied with spreading and absorption of
  /// every line (BinningResult::echo). Does nothing where the settings or SkipRule::multipath say so.
  /// @param echo [beam * lines + line]
  /// @throws RendererError when Embree fails.
  void add_to(std::vector<float>& echo, const SonarSettings& settings, const Pose& T_world_sonar,
              SkipCounts& skipped);

 private:
  bool is_needed(const MultipathSettings& settings, double max_range_m, const Pose& T_world_sonar) const;
  void collect(const SonarSettings& settings, const Pose& T_world_sonar, const PathLimits& limits);
  GhostPaths::Result search_small_parts(const Pose& T_world_sonar, const PathLimits& limits) const;
  void collect_glints(const std::vector<CornerCandidate>& corners, const SonarSettings& settings,
                      const Pose& T_world_sonar, const PathLimits& limits);
  void sum(const RangeLines& range, std::vector<float>& echo);

  World world_;  // meshes are shared; bodies are where they were last moved to
  WorkerPool& workers_;
  const SkipSwitches skip_;
  MirrorSurvey survey_;
  std::unique_ptr<PathScene> scene_;
  std::unique_ptr<PathFan> fan_;
  GhostPaths ghosts_;
  std::vector<std::vector<EchoPatch>> patches_of_beam_;
};

}  // namespace sonard::render
