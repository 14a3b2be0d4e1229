// SPDX-License-Identifier: Apache-2.0
// The main loop of `sonarview micron`.
#pragma once

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/micron/options.hpp"

namespace sonard::client {

/// Runs until a limit of `options`, SIGINT or SIGTERM. Prints the scan, its lines and the summary to standard
/// output, everything else to standard error.
/// @throws std::runtime_error (folder for pictures, file for lines)
ExitStatus view_micron(const MicronOptions& options);

}  // namespace sonard::client
