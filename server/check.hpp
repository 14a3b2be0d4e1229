// SPDX-License-Identifier: Apache-2.0
// `sonard check`: tests everything that can be known before serving, including assets and addresses.
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
  std::vector<std::string> summary;            ///< findings, for people
  std::map<std::string, double> cost_ms;       ///< of a ping on the CPU, by head name
  DaemonConfig config;                         ///< including values resolved from its world
  std::shared_ptr<const render::World> world;  ///< null if it cannot be read
};

/// Loads the world and the trajectory, builds every head's sample grid, and renders a ping of each head on
/// the CPU. With `try_addresses` it also binds each socket for a moment. Needs no GL.
CheckReport check_config(const LoadedConfig& loaded, bool try_addresses);

}  // namespace sonard::server
