// SPDX-License-Identifier: Apache-2.0
// `sonard demo`: starts the daemon, poses and a client, to show what sonard does.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonard::server {

struct DemoOptions {
  std::string name;                          ///< one of demo_names(); empty: the first
  std::filesystem::path out;                 ///< folder of pictures and program output; empty: not written
  std::optional<std::chrono::seconds> time;  ///< nullopt: until SIGINT or SIGTERM
};

/// The entries of configs/demo/list.yaml, in file order.
std::vector<std::string> demo_names();

/// Starts `sonard run` with the configuration of the demo. When it is ready, starts `posecast` and
/// `sonarview` from the folder of this program. Prints where to look, and the client's lines. Configurations
/// come from ../share/sonard/configs beside the program (installed), else from the source tree of its build.
/// @return exit_clean; exit_config for an unknown demo; exit_internal if a program ended by itself (its last
/// lines are printed)
int run_demo(const DemoOptions& options);

}  // namespace sonard::server
