// SPDX-License-Identifier: Apache-2.0
// `sonard check`: everything that can be known before serving, assets and addresses included.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/scene/world.hpp"
#include "server/config/loader.hpp"

namespace sonard::server {

struct CheckReport {
  std::vector<std::string> problems;           ///< one line each: file, line, key, what is wrong
  std::vector<std::string> warnings;           ///< in the form of `problems`
  std::vector<std::string> summary;            ///< what was found, for people
  DaemonConfig config;                         ///< with what it takes from its world
  std::shared_ptr<const render::World> world;  ///< null when it cannot be read
};

/// Loads the world and the trajectory, grids every head's fan, renders a ping of each head on the CPU and,
/// with `try_addresses`, binds each socket for a moment. Needs no GL.
CheckReport check_config(const LoadedConfig& loaded, bool try_addresses);

}  // namespace sonard::server
