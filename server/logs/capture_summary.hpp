// What passed between heads and clients in a .pcapng.
#pragma once

#include "server/logs/log_summary.hpp"

namespace sonard::server {

/// Pings of Geminis by their ping heads, at the times at which they were captured; other packets by
/// transport.
/// @throws LogError when the file is broken from its start
void summarise_capture(LogSummary& log, const LogFile& file);

}  // namespace sonard::server
