// SPDX-License-Identifier: Apache-2.0
// Texts about a scan, as key=value for scripts.
#pragma once

#include <cstdint>
#include <string>

#include "clients/sonarview/common/line_viewer.hpp"
#include "protocol/micron/client.hpp"
#include "protocol/micron/scan_settings.hpp"

namespace sonard::client {

/// "scan range_m=9.984 bins=400 bin_m=0.02496 ...": the requested settings.
std::string scan_text(const micron::ScanSettings& settings);

/// "line number=0 turn=0 bearing_deg=0.00 ...". @param bin_m length of a bin
std::string line_text(const micron::ReceivedLine& line, std::uint64_t sweep, double bin_m);

/// The last line of the program: "summary turns=... ".
std::string summary_text(const micron::ClientStatistics& statistics, std::uint64_t sweeps,
                         std::uint64_t lines_missed, const RunCounters& counters);

}  // namespace sonard::client
