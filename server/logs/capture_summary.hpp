// SPDX-License-Identifier: Apache-2.0
// Summarises the packets between heads and clients in a .pcapng.
#pragma once

#include "server/logs/log_summary.hpp"

namespace sonard::server {

/// Adds the pings that `ping_in` finds, with their capture times; other packets are counted by transport.
/// @throws Error if the file is broken at its start
void summarise_capture(LogSummary& log, const LogFile& file, const PingFinder& ping_in);

}  // namespace sonard::server
