// SPDX-License-Identifier: Apache-2.0
// Any bytes as one message of a Ping1D in both directions; fuzz_ping360_frames has the frames of a stream.
// Promises: decoded messages are stable under encode and decode; every error names a field inside the frame.
#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "protocol/ping1d/codec.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace sonard::ping1d;
using sonard::Result;
using sonard::WireError;
using sonard::fuzz::require;
using Bytes = std::vector<std::uint8_t>;

Result<Command, WireError> decode_again(const Command&, const Bytes& frame) {
  return decode_command(frame);
}
Result<Report, WireError> decode_again(const Report&, const Bytes& frame) {
  return decode_report(frame);
}

template <class Message>
void check_decoded(const Result<Message, WireError>& decoded, std::span<const std::uint8_t> frame) {
  if (!decoded) {
    require(decoded.error().offset <= frame.size(), "an error lies inside the frame");
    return;
  }
  if (std::holds_alternative<Unknown>(*decoded)) {
    require(id_of(*decoded) == frame_header(frame).message_id, "the number is kept");
    return;
  }
  const Bytes encoded = encode(*decoded);
  require(next_frame(encoded) == static_cast<std::ptrdiff_t>(encoded.size()), "what is encoded is a frame");
  const auto again = decode_again(*decoded, encoded);
  require(again.has_value() && *again == *decoded, "encoding loses nothing");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span stream{data, size};
  // With valid lengths and checksum, because few mutations hit a checksum.
  if (size >= 2 && size <= max_payload_size) {
    const Bytes frame =
        make_frame(static_cast<std::uint16_t>(data[0] | data[1] << 8), 0, 0, stream.subspan(2));
    check_decoded(decode_command(frame), frame);
    check_decoded(decode_report(frame), frame);
  }
  return 0;
}
