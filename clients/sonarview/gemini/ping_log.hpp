// SPDX-License-Identifier: Apache-2.0
// What sonarview says about pings, as key=value for scripts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/common/ping_job.hpp"
#include "protocol/gemini/topside.hpp"

namespace sonard::client {

/// CRC-32 (zlib's polynomial) of the samples, line after line, port to starboard; 16-bit samples most
/// significant byte first.
std::uint32_t samples_crc32(const gemini::PingSamples& samples);

/// "ping number=0 id=7 transmit_us=... lines=... beams=... lines_lost=... lines_repaired=... retries=...
/// crc32=... sonar_id=...".
std::string ping_line(const gemini::ReceivedPing& ping, std::uint16_t sonar_id);

/// Pings per second, from the end of the first to the end of the newest.
class PingRate {
 public:
  void add(TimePoint finished);
  /// 0 for fewer than two pings.
  double hz() const;

 private:
  std::uint64_t pings_ = 0;
  TimePoint first_{};
  TimePoint last_{};
};

/// What the program says of a head beside the counters of its topside.
struct ProgramCounters {
  std::uint16_t sonar_id = 0;
  double rate_hz = 0.0;
  std::uint64_t dropped_rx = 0;    ///< lost on purpose
  std::uint64_t dropped_tx = 0;    ///< lost on purpose
  std::uint64_t kernel_drops = 0;  ///< arrived when the receive buffer was full
  std::uint64_t images_written = 0;
  std::uint64_t images_skipped = 0;  ///< came faster than they could be written
};

/// The last line of the program: "summary pings_complete=... ".
std::string summary_line(const gemini::LinkStatistics& statistics, const ProgramCounters& counters);

}  // namespace sonard::client
