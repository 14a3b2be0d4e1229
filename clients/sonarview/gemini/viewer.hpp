// SPDX-License-Identifier: Apache-2.0
// The program between command line and exit status, with a Gemini 720i.
#pragma once

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/gemini/options.hpp"

namespace sonard::client {

/// Talks to a head until the limits in `options`, SIGINT or SIGTERM; prints ping lines and the summary on
/// standard output, everything else on standard error.
/// @throws SocketError, std::runtime_error (folder for pictures)
ExitStatus view_gemini(const GeminiOptions& options);

}  // namespace sonard::client
