// SPDX-License-Identifier: Apache-2.0
// The main loop of `sonarview ping360`.
#pragma once

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/ping360/options.hpp"

namespace sonard::client {

/// Runs until a limit of `options`, SIGINT or SIGTERM. Prints pings and the summary to standard output,
/// everything else to standard error.
/// @throws std::runtime_error (folder for pictures)
ExitStatus view_ping360(const Ping360Options& options);

}  // namespace sonard::client
