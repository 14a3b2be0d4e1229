// What goes between the head, which decides when and with what settings to ping, and whoever renders.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/gemini/device_config.hpp"
#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// One ping to be rendered, in SI units. The server maps it to renderer settings.
struct PingJob {
  /// Counts the jobs of a head: 0, 1, 2, ... Jobs that came to nothing leave gaps. The wire carries it modulo
  /// 256.
  std::uint64_t ping_number = 0;
  TimePoint transmit_time{};  ///< when the pulse leaves; later than now by DeviceConfig::render_lead at most
  int native_lines = 0;       ///< range lines before compression, 32..20000
  int compression_log2 = 0;   ///< 2^n native lines are averaged into one line of the image; 0..4
  double line_step_m = 0.0;   ///< range of one native line: sound_speed_mps / (2 * 90422 Hz)
  double sound_speed_mps = 0.0;  ///< true speed in the water
  /// What the head reckons with, and forms its beams by: that of the configuration, or its velocimeter's,
  /// which is true.
  double assumed_sound_speed_mps = 0.0;
  bool sixteen_bit = false;
  double pulse_s = 0.0;        ///< duration of the tone that is transmitted
  bool transmit = true;        ///< false: the head only listens, there are no echoes but there is noise
  double gain_db = 0.0;        ///< relative to 50 percent gain and nominal main gain (gain_law.hpp)
  double gain_percent = 50.0;  ///< what the client set, by gemini::gain_percent(): for logs
  int rle_threshold = 0;       ///< samples below it become zero when the image travels; 0: none do
  /// The RecordedPing that answers this job, whatever it asks for; nullopt: it is to be rendered.
  std::optional<std::uint64_t> record;
  std::optional<double> recorded_gain_percent;  ///< of that RecordedPing, if it is known

  /// Lines of the image; a remainder of native lines that fills no whole line is not sent.
  int lines() const { return native_lines >> compression_log2; }
};

/// The rendered samples of a job: PingJob::lines() lines of beam_count samples, line after line from short
/// range to long, each from port to starboard. `u16` is filled for 16-bit jobs, `u8` for all others.
struct PingImage {
  std::uint64_t ping_number = 0;
  std::vector<std::uint8_t> u8;
  std::vector<std::uint16_t> u16;
};

/// A ping that was recorded and is to be sent once more, as it was: of all that the surface asks for, a head
/// that plays back heeds only that it wants a ping. Its image has 8 bits and travels without run lengths.
struct RecordedPing {
  std::uint64_t record = 0;             ///< PingJob::record
  int lines = 0;                        ///< of the image
  int compression_log2 = 0;             ///< 0..4; lines * 2^n <= 65535
  double sound_speed_mps = 0.0;         ///< that the head reckoned with
  bool sound_speed_from_config = true;  ///< the surface had given it, not the velocimeter
  std::optional<double> gain_percent;   ///< it was made with; nullopt: nobody knows
  /// Earliest transmit time; nullopt: when the surface wants it.
  std::optional<TimePoint> due;
};

}  // namespace sonard::gemini
