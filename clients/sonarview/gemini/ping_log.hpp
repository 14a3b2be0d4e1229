// SPDX-License-Identifier: Apache-2.0
// Texts about pings, as key=value for scripts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/common/ping_job.hpp"
#include "protocol/gemini/client.hpp"

namespace sonard::client {

/// CRC-32 (zlib's polynomial) of the samples, line after line, port to starboard; 16-bit samples are
/// big-endian.
std::uint32_t samples_crc32(const gemini::ReceivedSamples& samples);

/// "ping number=0 id=7 transmit_us=... lines=... beams=... lines_lost=... lines_repaired=... retries=...
/// crc32=... sonar_id=...".
std::string ping_line(const gemini::ReceivedPing& ping, std::uint16_t sonar_id);

/// Pings per second, from the end of the first ping to the end of the newest.
class PingRateMeter {
 public:
  void add(TimePoint finished);
  /// 0 if there are fewer than two pings.
  double hz() const;

 private:
  std::uint64_t pings_ = 0;
  TimePoint first_{};
  TimePoint last_{};
};

/// Counters of a head in the summary, beside the counters of its client.
struct ProgramCounters {
  std::uint16_t sonar_id = 0;
  double rate_hz = 0.0;
  std::uint64_t dropped_rx = 0;    ///< dropped on purpose
  std::uint64_t dropped_tx = 0;    ///< dropped on purpose
  std::uint64_t kernel_drops = 0;  ///< dropped by the kernel because the receive buffer was full
  std::uint64_t images_written = 0;
  std::uint64_t images_skipped = 0;  ///< pings whose pictures were dropped, because the writer was too slow
};

/// The last line of the program: "summary pings_complete=... ".
std::string summary_line(const gemini::LinkStatistics& statistics, const ProgramCounters& counters);

}  // namespace sonard::client
