// SPDX-License-Identifier: Apache-2.0
// Any bytes as a stream of Ping360 frames, and as one message in both directions.
// Promises: the framing function keeps its contract; frames do not depend on how the stream is cut; decoded
// messages are stable under encode and decode; every error names a field inside the frame.
#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/discovery.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace sonard::ping360;
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

std::vector<Bytes> frames_of(std::span<const std::uint8_t> stream, std::size_t piece) {
  FrameBuffer buffer;
  std::vector<Bytes> frames;
  for (std::size_t begin = 0; begin < stream.size(); begin += piece) {
    buffer.append({}, stream.subspan(begin, std::min(piece, stream.size() - begin)));
    while (const auto frame = buffer.front()) {
      frames.emplace_back(frame->begin(), frame->end());
      buffer.pop();
    }
  }
  return frames;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span stream{data, size};
  const std::ptrdiff_t step = next_frame(stream);
  require(step <= static_cast<std::ptrdiff_t>(size) && -step <= static_cast<std::ptrdiff_t>(size),
          "a step stays inside the bytes");
  const auto whole = frames_of(stream, std::max<std::size_t>(size, 1));
  require(whole == frames_of(stream, 1) && whole == frames_of(stream, 7), "pieces make no difference");
  for (const Bytes& frame : whole) {
    check_decoded(decode_command(frame), frame);
    check_decoded(decode_report(frame), frame);
  }
  // As one message with valid lengths and checksum, because few mutations hit a checksum.
  if (size >= 2 && size <= max_payload_size) {
    const Bytes frame =
        make_frame(static_cast<std::uint16_t>(data[0] | data[1] << 8), 0, 0, stream.subspan(2));
    check_decoded(decode_command(frame), frame);
    check_decoded(decode_report(frame), frame);
  }
  require(!is_discovery(stream) || !set_ip(stream), "a datagram means one thing");
  return 0;
}
