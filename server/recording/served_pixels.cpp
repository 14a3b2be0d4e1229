#include "server/recording/served_pixels.hpp"

#include <variant>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/ping_assembly.hpp"
#include "server/recording/gemini_glf.hpp"

namespace sonard::server {

std::vector<std::uint8_t> served_pixels(const gemini::EncodedPing& ping) {
  gemini::PingAssembly assembly(static_cast<std::uint8_t>(ping.head().ping_id & 0xFF));
  assembly.set_head(ping.head());
  for (int line = 0; line < ping.line_count(); ++line) {
    const gemini::SharedBytes datagram = ping.datagram(1 + line);
    const auto report = gemini::decode_report({datagram.data(), datagram.size()});
    assembly.add_line(std::get<gemini::PingLine>(*report));  // of our own making
  }
  gemini::PingSamples samples = assembly.take_samples();
  return samples.u16.empty() ? std::move(samples.u8) : eight_bit_pixels(samples.u16);
}

}  // namespace sonard::server
