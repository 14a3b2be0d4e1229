// SPDX-License-Identifier: Apache-2.0
// `sonard demo`: the daemon, poses and a client at once, to see at once what sonard does.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonard::server {

struct DemoOptions {
  std::string name;                          ///< one of demo_names(); empty: the first
  std::filesystem::path out;                 ///< pictures and the programs' lines go there; empty: nowhere
  std::optional<std::chrono::seconds> time;  ///< nullopt: until SIGINT or SIGTERM
};

/// The entries of configs/demo/list.yaml, in their order.
std::vector<std::string> demo_names();

/// Starts `sonard run` with the configuration of the demo and, when it is ready, `posecast` and `sonarview`
/// that lie beside this program; prints where to look, and the client's lines. What it needs is looked for in
/// ../share/sonard/configs of the program, as installed, then in the source tree it was built in.
/// @return exit_clean; exit_config for a demo that there is not; exit_internal, with the last lines of the
/// program that ended by itself
int run_demo(const DemoOptions& options);

}  // namespace sonard::server
