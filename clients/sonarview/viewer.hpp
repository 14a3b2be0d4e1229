// The program between command line and exit status.
#pragma once

#include "clients/sonarview/options.hpp"

namespace sonard::client {

/// Talks to a head until the limits in `options`, SIGINT or SIGTERM; prints ping lines and the summary on
/// standard output, everything else on standard error.
/// @throws SocketError, std::runtime_error (folder for pictures)
ExitStatus view(const Options& options);

}  // namespace sonard::client
