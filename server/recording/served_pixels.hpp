// What a surface sees of a ping that was encoded for it.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/gemini/encoded_ping.hpp"

namespace sonard::server {

/// Samples of 8 bits, line after line, as GeminiPing::pixels has them: decoded from the datagrams, so after
/// run-length coding and its threshold; of 16-bit samples the high byte.
std::vector<std::uint8_t> served_pixels(const gemini::EncodedPing& ping);

}  // namespace sonard::server
