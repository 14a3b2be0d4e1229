// SPDX-License-Identifier: Apache-2.0
// Sends the standard error output of libraries to the log.
#pragma once

#include <string_view>

namespace sonard::server {

/// From the first call on, lines that libraries print to std::cerr go to the log as warnings, rate-limited
/// like a PeerLog, because peers cause most of them. Any thread may print.
void take_library_lines();

/// Logs one line of a library the same way. Any thread.
/// @param library prefix of the line: "libprotobuf"
void log_library_line(std::string_view library, std::string_view text);

}  // namespace sonard::server
