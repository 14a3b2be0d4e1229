// SPDX-License-Identifier: Apache-2.0
// The program between command line and exit status, with a Ping360.
#pragma once

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/ping360/options.hpp"

namespace sonard::client {

/// Talks to a head until the limits in `options`, SIGINT or SIGTERM; prints pings and the summary on standard
/// output, everything else on standard error.
/// @throws std::runtime_error (folder for pictures)
ExitStatus view_ping360(const Ping360Options& options);

}  // namespace sonard::client
