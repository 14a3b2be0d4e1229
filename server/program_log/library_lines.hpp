// SPDX-License-Identifier: Apache-2.0
// What libraries print to standard error, as lines of the log.
#pragma once

#include <string_view>

namespace sonard::server {

/// From the first call to the end of the process, lines that libraries print to std::cerr go to the log as
/// warnings, limited in rate as by a PeerLog: peers cause most of them. Any thread may print.
void take_library_lines();

/// Logs one line of a library in the same way. Any thread.
/// @param library begins the line: "libprotobuf"
void log_library_line(std::string_view library, std::string_view text);

}  // namespace sonard::server
