// SPDX-License-Identifier: Apache-2.0
// What passed between heads and clients in a .pcapng.
#pragma once

#include "server/logs/log_summary.hpp"

namespace sonard::server {

/// Pings where `ping_in` finds them, at the times at which they were captured; other packets by transport.
/// @throws LogError when the file is broken from its start
void summarise_capture(LogSummary& log, const LogFile& file, const PingFinder& ping_in);

}  // namespace sonard::server
