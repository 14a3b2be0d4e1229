// SPDX-License-Identifier: Apache-2.0
// One ping as the device requests it from the renderer. The device decides the time and the settings.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/common/directions.hpp"

namespace sonard {

/// Time on any monotonic clock that the caller chooses; only differences matter.
using TimePoint = std::chrono::nanoseconds;

/// One setting as a log line shows it: "range" and "20.00m".
struct Setting {
  std::string name;
  std::string value;

  bool operator==(const Setting&) const = default;
};

/// A difference between a client's request and the recording.
struct Difference {
  std::string kind;  ///< "range", "gain", ...
  std::string text;  ///< one phrase: "range 20.00 m requested, 4.00 m sent"
};

/// One ping to render, in SI units. Members that a device does not set keep their defaults.
struct PingJob {
  /// Counts the jobs of a head: 0, 1, 2, ... Cancelled or failed jobs leave gaps.
  std::uint64_t number = 0;
  TimePoint transmit_time{};      ///< when the pulse leaves; each device documents how far ahead it may be
  std::uint64_t transmit_us = 0;  ///< transmit time on the clock of the head, microseconds
  std::chrono::nanoseconds listening_time{};  ///< until the echo of the last range bin arrives
  /// From this ping to the next if images arrive in time: the shortest period that the client requests and
  /// the head supports.
  std::chrono::nanoseconds period{};

  /// Bearing of a scanning head's beam about the head's vertical: 0 ahead, positive to starboard, in [-pi,
  /// pi]. 0 for a multibeam head.
  double bearing_rad = 0.0;
  int native_bins = 0;        ///< range bins before compression
  double native_bin_m = 0.0;  ///< range extent of a native bin: bin k covers [k, k + 1) times this
  int compression_log2 = 0;   ///< 2^n native bins are averaged into one bin of the image; 0..4
  bool sixteen_bit = false;   ///< requested width of the samples; false: 8 bits
  int mode = 0;               ///< ping mode, for heads with several; each device type has its own numbering
  int beams = 0;  ///< for heads whose number of beams a client can choose; 0: set by the device type
  /// If set, the answer has the range in each direction and no image. Two native bins are then as long as the
  /// range resolution of the pulse.
  Directions directions{};
  /// A sample is proportional to the amplitude to this power; > 0. A client may choose it.
  double amplitude_exponent = 1.0;

  double sound_speed_mps = 0.0;  ///< true speed in the water
  /// The speed that the head assumes in its beamforming; 0: the head forms no beams.
  double assumed_sound_speed_mps = 0.0;
  double pulse_s = 0.0;        ///< duration of a tone; 0: not a tone, or set by the device type
  double frequency_hz = 0.0;   ///< frequency of a tone, if a client can choose it; 0: set by the device type
  bool transmit = true;        ///< false: the head only listens; the image holds noise but no echoes
  double gain_db = 0.0;        ///< on the scale of the device
  double gain_percent = 50.0;  ///< as set by the client, 0..100; for logs

  /// ReplayedPing::record of the ping that answers this job whatever its settings; nullopt: render the job.
  std::optional<std::uint64_t> record;
  std::vector<Difference> differences;  ///< between this job and that recorded ping
  std::vector<Setting> settings;        ///< as set by the client, for the log

  /// Bins of the image. Remaining native bins that do not fill a bin are not sent.
  int bins() const { return native_bins >> compression_log2; }
  double bin_m() const { return native_bin_m * (1 << compression_log2); }
  double range_m() const { return native_bins * native_bin_m; }
};

/// Readings of a head's sensors of attitude, depth and motion at one time. A head without these sensors
/// ignores them.
struct SensorReadings {
  double heading_rad = 0.0;  ///< of the head's x axis, clockwise from north (world y axis); [0, 2 pi)
  double pitch_rad = 0.0;    ///< positive: nose up; [-pi/2, pi/2]
  double roll_rad = 0.0;     ///< positive: starboard side down; [-pi, pi]
  std::optional<double>
      depth_m;  ///< below the water surface, negative above it; nullopt: the world has no water surface
  /// Unit quaternion from the axes of the head to those of the world (x east, y north, z up).
  std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};
  std::array<double, 3> velocity_mps{};  ///< of the head over ground, in its axes
  /// In simulated time, the time of SensorsRead on the clock of the simulation.
  std::optional<std::chrono::nanoseconds> simulated_time = {};

  bool operator==(const SensorReadings&) const = default;
};

/// The rendered samples of a job: PingJob::bins() times the number of beams, bin after bin from near to far,
/// each bin from port to starboard. `u16` is filled for 16-bit jobs, `u8` for all others, `directions`
/// instead of both if the job asks for directions.
struct PingImage {
  std::uint64_t number = 0;  ///< PingJob::number
  std::vector<std::uint8_t> u8;
  std::vector<std::uint16_t> u16;
  std::optional<SensorReadings> readings = {};  ///< at the transmit time; nullopt: not known
  DirectionRanges directions = {};
};

/// The ping that a head begins at the next NextPingDue.
struct NextPing {
  std::chrono::nanoseconds from{};       ///< earliest start, on the clock of Device::step()
  std::chrono::nanoseconds period{};     ///< from the last ping to this one, in real or simulated time
  std::chrono::nanoseconds listening{};  ///< from transmission to the last echo, in real or simulated time
};

}  // namespace sonard
