// What goes between the head, which decides when and where to ping, and whoever renders.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/micron/frame.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// One ping to be rendered, in SI units. The server maps it to renderer settings.
struct MicronJob {
  /// Counts the jobs of a head: 0, 1, 2, ... The wire does not carry it.
  std::uint64_t ping_number = 0;
  TimePoint transmit_time{};  ///< when the pulse leaves; up to 50 ms before now where the caller is late
  std::uint16_t bearing = 0;  ///< as the wire has it, 1/16 gradian
  /// Axis of the beam about the head's vertical, 0 ahead, positive to starboard of the vehicle, in
  /// [-pi, pi]. A head mounted boot down without the invert bit looks to the other side than it says.
  double bearing_rad = 0.0;
  int bins = 0;                  ///< 1..1500
  double bin_time_s = 0.0;       ///< of the echo, between two bins: 640 ns and more
  double bin_length_m = 0.0;     ///< bin_time_s * sound_speed_mps / 2; bin k holds [k, k + 1) of it
  double sound_speed_mps = 0.0;  ///< true speed in the water
  double gain_db = 0.0;          ///< initial gain, 0..80 dB
  double ad_low_db = 0.0;        ///< window of 4-bit data; the head applies it, not the renderer
  double ad_span_db = 0.0;
  bool eight_bit = true;  ///< how the line will travel; the samples are 8-bit ones always
  bool transmit = true;   ///< false: the head only listens, there are no echoes but there is noise
  /// The RecordedLine that answers this job, and is what all the above says; nullopt: it is to be rendered.
  std::optional<std::uint64_t> record;

  double range_m() const { return bins * bin_length_m; }
  /// Until the echo of the last bin is in.
  std::chrono::nanoseconds listening_time() const {
    return std::chrono::nanoseconds{static_cast<std::int64_t>(1e9 * bins * bin_time_s)};
  }
};

/// The rendered samples of a job: MicronJob::bins of them, from near to far, 0..255 = 0..80 dB of receiver
/// output (docs/protocols/micron.md 6.3). Those of a RecordedLine are its bins as they travelled.
struct MicronLine {
  std::uint64_t ping_number = 0;
  std::vector<std::uint8_t> samples;
};

/// A line that has left, for those who keep what a head said.
struct SentLine {
  std::uint64_t ping_number = 0;
  HeadData line;                   ///< without data
  std::vector<std::uint8_t> bins;  ///< as they travelled: 0..255, or 0..15 where a line has 4 bits a bin
};

/// A line that was recorded and is to be sent once more, as it was: of all that the host asks for, a head
/// that plays back heeds only that it wants a line.
struct RecordedLine {
  std::uint64_t record = 0;      ///< MicronJob::record
  HeadData line;                 ///< as it travelled; without data
  int bins = 0;                  ///< 1..1500
  double bearing_rad = 0.0;      ///< MicronJob::bearing_rad
  double sound_speed_mps = 0.0;  ///< MicronJob::sound_speed_mps
  /// Earliest transmit time; nullopt: when the host wants it.
  std::optional<TimePoint> due;
};

}  // namespace sonard::micron
