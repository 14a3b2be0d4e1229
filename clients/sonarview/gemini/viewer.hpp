// SPDX-License-Identifier: Apache-2.0
// The main loop of `sonarview gemini`.
#pragma once

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/gemini/options.hpp"

namespace sonard::client {

/// Runs until a limit of `options`, SIGINT or SIGTERM. Prints ping lines and the summary to standard output,
/// everything else to standard error.
/// @throws SocketError, std::runtime_error (folder for pictures)
ExitStatus view_gemini(const GeminiOptions& options);

}  // namespace sonard::client
