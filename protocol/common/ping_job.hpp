// SPDX-License-Identifier: Apache-2.0
// One ping, on its way from the device, which decides when and with what settings to ping, to the renderer.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sonard {

/// Time on any monotonic clock of the caller's choice; only differences matter.
using TimePoint = std::chrono::nanoseconds;

/// One setting as a line of the log shows it: "range" and "20.00m".
struct Setting {
  std::string name;
  std::string value;

  bool operator==(const Setting&) const = default;
};

/// Something that a client asked for and a recording does not have.
struct Difference {
  std::string kind;  ///< "range", "gain", ...
  std::string text;  ///< one phrase: "range 20.00 m asked for, 4.00 m sent"
};

/// One ping to be rendered, in SI units. Every device fills in what it has; the rest keeps its default.
struct PingJob {
  /// Counts the jobs of a head: 0, 1, 2, ... Jobs that came to nothing leave gaps.
  std::uint64_t number = 0;
  TimePoint transmit_time{};      ///< when the pulse leaves; a device says how far from now it may be
  std::uint64_t transmit_us = 0;  ///< transmit time by the clock of the head
  std::chrono::nanoseconds listening_time{};  ///< until the echo of the last range bin is back
  /// From this ping to the next where images are there in time: the fastest that the client asks for and the
  /// head can do.
  std::chrono::nanoseconds period{};

  /// Axis of the beam of a scanning head about the head's vertical: 0 ahead, positive to starboard, in
  /// [-pi, pi]. A multibeam head does not turn: 0.
  double bearing_rad = 0.0;
  int native_bins = 0;        ///< range bins before compression
  double native_bin_m = 0.0;  ///< range of each: bin k holds [k, k + 1) of it
  int compression_log2 = 0;   ///< 2^n of them are averaged into one bin of the image; 0..4
  bool sixteen_bit = false;   ///< width of the samples that are asked for; false: 8 bits
  int mode = 0;               ///< of a head that pings in several ways, as its kind numbers them
  int beams = 0;              ///< of a head that forms more or fewer as it is asked; 0: the kind knows
  /// A sample is in proportion to the amplitude to this power, which a client may choose; > 0.
  double amplitude_exponent = 1.0;

  double sound_speed_mps = 0.0;  ///< true speed in the water
  /// The speed that the head is set to and forms its beams by; 0: it forms none.
  double assumed_sound_speed_mps = 0.0;
  double pulse_s = 0.0;        ///< duration of a tone; 0: the pulse is none, or the kind of device knows
  double frequency_hz = 0.0;   ///< of a tone whose frequency a client chooses; 0: the kind of device knows
  bool transmit = true;        ///< false: the head only listens, there are no echoes but there is noise
  double gain_db = 0.0;        ///< by the scale of the device
  double gain_percent = 50.0;  ///< what the client set: for logs

  /// RecordedPing::record of the ping that answers this job, whatever it asks for; nullopt: it is to be
  /// rendered.
  std::optional<std::uint64_t> record;
  std::vector<Difference> differences;  ///< from that recorded ping
  std::vector<Setting> settings;        ///< what the client has set, for the log

  /// Bins of the image; a remainder of native bins that fills no whole bin is not sent.
  int bins() const { return native_bins >> compression_log2; }
  double bin_m() const { return native_bin_m * (1 << compression_log2); }
  double range_m() const { return native_bins * native_bin_m; }
};

/// What the sensors of a head read at one time: how it is turned and how deep it is. A head without such
/// sensors ignores it.
struct SensorReadings {
  double heading_rad = 0.0;  ///< of its x axis, clockwise from north, the y axis of the world; [0, 2 pi)
  double pitch_rad = 0.0;    ///< positive: nose up; [-pi/2, pi/2]
  double roll_rad = 0.0;     ///< positive: starboard side down; [-pi, pi]
  std::optional<double>
      depth_m;  ///< below the water surface, negative above it; nullopt: there is no surface

  bool operator==(const SensorReadings&) const = default;
};

/// The rendered samples of a job: PingJob::bins() times the number of beams, bin after bin from near to far,
/// each from port to starboard. `u16` is filled for 16-bit jobs, `u8` for all others.
struct PingImage {
  std::uint64_t number = 0;  ///< of the job
  std::vector<std::uint8_t> u8;
  std::vector<std::uint16_t> u16;
  std::optional<SensorReadings> readings = {};  ///< at the transmit time; nullopt: not known
};

/// The ping that a head begins next if it is granted.
struct NextPing {
  std::chrono::nanoseconds from{};       ///< not before this, on the clock that the head is given
  std::chrono::nanoseconds period{};     ///< from the last ping to this one, in whatever time rules
  std::chrono::nanoseconds listening{};  ///< until its last echo is back, in the same
};

}  // namespace sonard
