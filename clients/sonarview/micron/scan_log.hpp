// SPDX-License-Identifier: Apache-2.0
// What sonarview says about a scan, as key=value for scripts.
#pragma once

#include <cstdint>
#include <string>

#include "protocol/micron/host.hpp"
#include "protocol/micron/scan_settings.hpp"

namespace sonard::client {

/// "scan range_m=9.984 bins=400 bin_m=0.02496 ...": what the head was asked to do.
std::string scan_text(const micron::ScanSettings& settings);

/// "line number=0 turn=0 bearing_deg=0.00 ...". `bin_m`: length of a bin.
std::string line_text(const micron::ReceivedLine& line, std::uint64_t sweep, double bin_m);

/// Counters of the program beside those of the host.
struct ScanCounters {
  std::uint64_t sweeps = 0;
  std::uint64_t lines_missed = 0;
  double rate_hz = 0.0;
  std::uint64_t reconnects = 0;
  std::uint64_t images_written = 0;
  std::uint64_t images_skipped = 0;
};

/// The last line of the program: "summary turns=... ".
std::string summary_text(const micron::HostStatistics& statistics, const ScanCounters& counters);

}  // namespace sonard::client
