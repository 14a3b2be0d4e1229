// SPDX-License-Identifier: Apache-2.0
// `sonard check`: everything that can be known before serving, assets and addresses included.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "renderer/scene/world.hpp"
#include "server/config/loader.hpp"

namespace sonard::server {

struct CheckReport {
  std::vector<ConfigProblem> problems;
  std::vector<ConfigProblem> warnings;
  std::vector<std::string> summary;            ///< what was found, for people
  std::map<std::string, double> cost_ms;       ///< of a ping by the CPU, by head
  DaemonConfig config;                         ///< with what it takes from its world
  std::shared_ptr<const render::World> world;  ///< null when it cannot be read
};

/// Loads the world and the trajectory, grids every head's fan, renders a ping of each head on the CPU and,
/// with `try_addresses`, binds each socket for a moment. Needs no GL.
CheckReport check_config(const LoadedConfig& loaded, bool try_addresses);

}  // namespace sonard::server
