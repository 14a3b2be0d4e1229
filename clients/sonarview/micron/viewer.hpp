// SPDX-License-Identifier: Apache-2.0
// The program between command line and exit status, with a Micron.
#pragma once

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/micron/options.hpp"

namespace sonard::client {

/// Talks to a head until the limits in `options`, SIGINT or SIGTERM; prints the scan, its lines and the
/// summary on standard output, everything else on standard error.
/// @throws std::runtime_error (folder for pictures, file for lines)
ExitStatus view_micron(const MicronOptions& options);

}  // namespace sonard::client
