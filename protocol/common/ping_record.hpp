// SPDX-License-Identifier: Apache-2.0
// One ping as logs store it, for all devices.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/common/ping_job.hpp"

namespace sonard {

/// Settings of a recorded ping, as far as the log contains them.
struct RecordedSettings {
  int bins = 0;
  int beams = 0;                        ///< 1: a line of a scanning head
  double bin_m = 0.0;                   ///< range extent of a bin: bin k covers [k, k + 1) times this
  double sound_speed_mps = 0.0;         ///< used to compute ranges
  bool sound_speed_from_config = true;  ///< true: set by a client; false: measured by the head
  double gain_percent = -1.0;           ///< 0..100; below 0: not in the log
  double frequency_hz = 0.0;            ///< of the sound; 0: not in the log
  /// Samples are proportional to the amplitude to this power, > 0; 1 for samples in decibels.
  double amplitude_exponent = 1.0;

  double range_m() const { return bins * bin_m; }
  bool operator==(const RecordedSettings&) const = default;
};

/// An echo at a place. Axes of the head as in REP-103: x forward, y to port, z up, in metres.
struct EchoPoint {
  float x = 0.0F, y = 0.0F, z = 0.0F;
  float intensity = 0.0F;  ///< the sample

  bool operator==(const EchoPoint&) const = default;
};

/// A ping that a head has sent, for logs.
struct PingRecord {
  std::uint64_t number = 0;  ///< PingJob::number
  TimePoint transmit_time{};
  RecordedSettings settings;
  /// Bearing of each beam about the vertical of the head: 0 ahead, positive to starboard.
  std::vector<double> bearings_rad;
  double sector_rad = 0.0;  ///< total sector of a multibeam head's beams; 0 for a scanning head
  /// 2^n of the head's own range lines make one bin.
  int range_compression_log2 = 0;
  int bits_per_bin = 8;  ///< on the wire: 8, or 4 if samples are 0..15
  /// Bin after bin from near to far, each bin from port to starboard, as a client has them after decoding.
  std::vector<std::uint8_t> samples;
  std::vector<std::uint8_t> wire;  ///< the message on the wire without its samples; empty: not kept
  /// The echoes of a head that measures directions, whose `samples` are a fan of them; nullopt: another head.
  std::optional<std::vector<EchoPoint>> points;
};

/// The record of a scanning head's ping, without samples, `wire`, number and transmit time.
inline PingRecord line_record(const PingJob& job) {
  PingRecord record;
  record.settings = {.bins = job.bins(),
                     .beams = 1,
                     .bin_m = job.bin_m(),
                     .sound_speed_mps = job.sound_speed_mps,
                     .gain_percent = job.gain_percent,
                     .frequency_hz = job.frequency_hz};
  record.bearings_rad = {job.bearing_rad};
  return record;
}

/// A recorded ping to send again unchanged. A head that plays back ignores a client's settings and sends it.
struct ReplayedPing {
  std::uint64_t record = 0;  ///< PingJob::record
  RecordedSettings settings;
  double bearing_rad = 0.0;        ///< of a scanning head's beam, see PingRecord::bearings_rad
  int bits_per_bin = 8;            ///< see PingRecord
  std::vector<std::uint8_t> wire;  ///< see PingRecord
  std::optional<TimePoint> due;    ///< earliest transmit time; nullopt: at a client's next request
};

}  // namespace sonard
