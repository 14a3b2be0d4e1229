// SPDX-License-Identifier: Apache-2.0
// `sonard render`: renders a trajectory to files.
#pragma once

#include "server/config/loader.hpp"
#include "server/offline/options.hpp"

namespace sonard::server {

/// Renders the missing frames of this process. The process that finds all frames of all processes at its end
/// also makes the logs. docs/offline.md describes the files.
/// @return exit_clean
/// @throws Error, pose::TrajectoryError, render::RequestError, render::RendererError
int render_trajectory(const LoadedConfig& loaded, const OfflineOptions& options);

}  // namespace sonard::server
