// The one place that knows both what a Gemini sends and what a .glf log keeps of it (docs/logs.md 1.4, 1.5).
// Pure: whoever has a ping, serving, rendering a trajectory or playing a log back, gets the same record.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/gemini/messages.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::server {

/// One ping as it goes to the surface.
struct GeminiPing {
  gemini::PingHead head;  ///< complete, as it is sent; says how many lines and beams there are
  /// head.line_count() * head.beams samples of 8 bits, line after line from near to far, port to starboard,
  /// as a surface has them after decoding: where beams below a threshold travel as zeros, they are zeros.
  std::vector<std::uint8_t> pixels;
  std::int64_t transmit_unix_ns = 0;  ///< when the pulse left
  double gain_percent = 50.0;         ///< as the early client library counts (gemini::gain_percent())
};

/// Clock and identity of the log that a record goes into.
struct GlfLogOrigin {
  std::int32_t utc_offset_s = 0;   ///< of the zone of the log, the same for all of it
  std::uint8_t gemini_number = 0;  ///< 0..9, counted over the Geminis of a vehicle; makes the node id
};

/// 16-bit samples as a log can keep them: the high byte of each.
std::vector<std::uint8_t> eight_bit_pixels(const std::vector<std::uint16_t>& samples);

/// The device id is that of the header of `ping.head`.
glf::ImageRecord to_glf_image(GeminiPing ping, const GlfLogOrigin& origin);

/// What a status of the head says in fields that a log has. Temperatures of amplifiers that a 720i does not
/// have are 0.
glf::StatusRecord to_glf_status(const gemini::Status& status, std::int64_t unix_ns,
                                const GlfLogOrigin& origin);

}  // namespace sonard::server
