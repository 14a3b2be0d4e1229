// SPDX-License-Identifier: Apache-2.0
// What the heads of a configuration see from a pose of the vehicle, before anybody is served.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"
#include "server/diagnosis/finding.hpp"
#include "server/diagnosis/sight.hpp"
#include "server/pose/posed_body.hpp"

namespace sonard::server {

/// Pings of a configuration's heads with their usual settings, rendered on the CPU. For one thread.
class TrialPings {
 public:
  /// @param config with its mounts resolved (resolve_mounts()); outlives this object, as does the world
  TrialPings(const DaemonConfig& config, const render::World& world);

  /// Renders one ping of a head; of one that scans one ahead, and one every 30 degrees. The first of a head
  /// also builds what the next ones use.
  /// @param moved bodies that are not where the world has them; the vehicle's own model moves by itself
  /// @return what looks wrong there; empty: nothing does
  /// @throws render::RequestError when the sampling cannot be had
  std::vector<Finding> ping(std::size_t head, const render::Pose& T_world_vehicle,
                            std::vector<PosedBody> moved = {});

  /// Where the head looks, and what it would see of the bed: "forward and 20 degrees down; the bed below
  /// ('seabed') is seen from 6.1 to 40 m". Renders nothing.
  /// @param T_world_vehicle nullopt: not known, and nothing is said of the bed
  std::string view(std::size_t head, const std::optional<render::Pose>& T_world_vehicle,
                   const std::vector<PosedBody>& moved = {}) const;

  /// What a ping of a head takes here with the machine to itself, in milliseconds: the least of three, in
  /// processor time, because other programs lengthen the time by the clock. Call ping() for the head first.
  /// @throws render::RequestError when the sampling cannot be had
  double cost_ms(std::size_t head, render::Pose T_world_vehicle);

 private:
  void move_bodies(const std::vector<PosedBody>& moved);

  const DaemonConfig& config_;
  const render::World& world_;
  std::vector<BodyBox> boxes_;
  render::SonarRenderer renderer_;
};

}  // namespace sonard::server
