// SPDX-License-Identifier: Apache-2.0
// Views of a configuration's heads from a pose of the vehicle, rendered before serving.
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

  /// Renders one ping of a head. A scanning head renders one ping ahead and one every 30 degrees. The first
  /// ping of a head also builds caches for the next ones.
  /// @param moved bodies that are not at their pose in the world; the vehicle's own model moves by itself
  /// @return findings about the place; empty if nothing looks wrong
  /// @throws render::RequestError if the sampling is not possible
  std::vector<Finding> ping(std::size_t head, const render::Pose& T_world_vehicle,
                            std::vector<PosedBody> moved = {});

  /// Direction of the head and its view of the bed: "forward and 20 degrees down; the bed below ('seabed') is
  /// seen from 6.1 to 40 m". Renders nothing.
  /// @param T_world_vehicle nullopt: not known, and the text omits the bed
  std::string view(std::size_t head, const std::optional<render::Pose>& T_world_vehicle,
                   const std::vector<PosedBody>& moved = {}) const;

  /// Time of a ping of a head on an idle machine, in milliseconds: the least of three, as processor time,
  /// because other programs lengthen the wall time. Call ping() for the head first.
  /// @throws render::RequestError if the sampling is not possible
  double cost_ms(std::size_t head, render::Pose T_world_vehicle);

 private:
  void move_bodies(const std::vector<PosedBody>& moved);

  const DaemonConfig& config_;
  const render::World& world_;
  std::vector<BodyBox> boxes_;
  render::SonarRenderer renderer_;
};

}  // namespace sonard::server
