// SPDX-License-Identifier: Apache-2.0
// Any bytes as one Gemini datagram, in both directions, and as run-length coded data.
// Promises: no datagram is read beyond its end; decoded messages are stable under encode and decode; every
// error names a field inside the datagram; run-length decoding stays inside the line.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/rle.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using sonard::Result;
using sonard::WireError;
using sonard::fuzz::require;
using Bytes = std::vector<std::uint8_t>;

Result<sonard::gemini::Command, WireError> decode_again(const sonard::gemini::Command&, const Bytes& bytes) {
  return sonard::gemini::decode_command(bytes);
}
Result<sonard::gemini::Report, WireError> decode_again(const sonard::gemini::Report&, const Bytes& bytes) {
  return sonard::gemini::decode_report(bytes);
}

template <class Message>
void check_decoded(const Result<Message, WireError>& decoded, std::span<const std::uint8_t> datagram) {
  if (!decoded) {
    require(decoded.error().offset <= datagram.size(), "an error lies inside the datagram");
    require(!to_string(decoded.error()).empty(), "an error has a text");
    return;
  }
  require(type_of(*decoded) == datagram[0], "the type is kept");
  const Bytes encoded = encode(*decoded);
  const auto again = decode_again(*decoded, encoded);
  require(again.has_value(), "what is encoded can be decoded");
  // Only MdioCommands may lose data: encode() cuts them to the size of one datagram.
  require(*again == *decoded || datagram.size() > sonard::gemini::max_datagram_size,
          "encoding loses nothing");
}

void check_rle(std::span<const std::uint8_t> data) {
  constexpr std::size_t beam_count = 256;
  Bytes beams(beam_count);
  require(sonard::gemini::rle_decode(data, beams) <= beam_count, "no more beams than there are");

  const Bytes line(data.begin(),
                   data.begin() + static_cast<std::ptrdiff_t>(std::min(data.size(), beam_count)));
  constexpr std::uint8_t threshold = 3;
  Bytes coded;
  sonard::gemini::rle_encode(line, threshold, coded);
  Bytes back(line.size());
  require(sonard::gemini::rle_decode(coded, back) == line.size(), "all beams come back");
  require(std::ranges::equal(line, back,
                             [](std::uint8_t sent, std::uint8_t received) {
                               return received == (sent < threshold ? 0 : sent);
                             }),
          "beams come back with the small ones zeroed");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span datagram{data, size};
  check_decoded(sonard::gemini::decode_command(datagram), datagram);
  check_decoded(sonard::gemini::decode_report(datagram), datagram);
  check_rle(datagram);
  return 0;
}
