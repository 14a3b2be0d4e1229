// SPDX-License-Identifier: Apache-2.0
// One ping as logs keep it, whichever device made it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/common/ping_job.hpp"

namespace sonard {

/// What a ping was made with, as far as a log says.
struct RecordedSettings {
  int bins = 0;
  int beams = 0;                        ///< 1: a line of a scanning head
  double bin_m = 0.0;                   ///< bin k holds [k, k + 1) of it
  double sound_speed_mps = 0.0;         ///< that ranges are computed with
  bool sound_speed_from_config = true;  ///< a client had set it; false: the head measured it
  double gain_percent = -1.0;           ///< 0..100; below 0: the log does not say
  double frequency_hz = 0.0;            ///< of the sound; 0: the log does not say
  /// Samples are in proportion to the amplitude to this power, > 0; of those that are decibels it is 1.
  double amplitude_exponent = 1.0;

  double range_m() const { return bins * bin_m; }
  bool operator==(const RecordedSettings&) const = default;
};

/// A ping that has gone out, for logs.
struct PingRecord {
  std::uint64_t number = 0;  ///< of its job
  TimePoint transmit_time{};
  RecordedSettings settings;
  /// Bearing of each beam about the vertical of the head: 0 ahead, positive to starboard.
  std::vector<double> bearings_rad;
  double sector_rad = 0.0;  ///< filled by the beams of a multibeam head; 0 for a scanning head
  /// A bin is made of two to the power of this of the head's own range lines.
  int range_compression_log2 = 0;
  int bits_per_bin = 8;  ///< on the wire: 8, or 4 where samples are 0..15
  /// Bin after bin from near to far, each from port to starboard, as a client has them after decoding.
  std::vector<std::uint8_t> samples;
  std::vector<std::uint8_t> wire;  ///< the message on the wire without its samples; empty: there is none
};

/// A recorded ping to be sent again unchanged. A head that plays back ignores the settings that a client asks
/// for and sends this ping instead.
struct RecordedPing {
  std::uint64_t record = 0;  ///< PingJob::record
  RecordedSettings settings;
  double bearing_rad = 0.0;        ///< of the beam of a scanning head, see PingRecord::bearings_rad
  int bits_per_bin = 8;            ///< see PingRecord
  std::vector<std::uint8_t> wire;  ///< see PingRecord
  std::optional<TimePoint> due;    ///< earliest transmit time; nullopt: when a client wants it
};

}  // namespace sonard
