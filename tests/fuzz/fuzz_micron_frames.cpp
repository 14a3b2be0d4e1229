// SPDX-License-Identifier: Apache-2.0
// Any bytes as a stream of Micron frames, and as one frame in both directions.
// Promises: the framing function keeps its contract; frames do not depend on how the stream is cut; decoded
// messages are stable under encode and decode; every error names a field inside the frame.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/micron/codec.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace sonard::micron;
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
  require(type_of(*decoded) == frame[10], "the type is kept");
  const Bytes encoded = encode(*decoded);
  require(next_frame(encoded, max_report_frame_size) == static_cast<std::ptrdiff_t>(encoded.size()),
          "what is encoded is a frame");
  const auto again = decode_again(*decoded, encoded);
  require(again.has_value() && *again == *decoded, "encoding loses nothing");
}

std::vector<Bytes> frames_of(std::span<const std::uint8_t> stream, std::size_t piece) {
  FrameBuffer buffer{max_command_frame_size};
  std::vector<Bytes> frames;
  for (std::size_t begin = 0; begin < stream.size(); begin += piece) {
    buffer.append({}, stream.subspan(begin, std::min(piece, stream.size() - begin)));
    while (const auto frame = buffer.front({})) {
      frames.emplace_back(frame->bytes.begin(), frame->bytes.end());
      buffer.pop();
    }
  }
  return frames;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span stream{data, size};
  const std::ptrdiff_t step = next_frame(stream, max_command_frame_size);
  require(step <= static_cast<std::ptrdiff_t>(size) && -step <= static_cast<std::ptrdiff_t>(size),
          "a step stays inside the bytes");
  const auto whole = frames_of(stream, std::max<std::size_t>(size, 1));
  require(whole == frames_of(stream, 1) && whole == frames_of(stream, 7), "pieces make no difference");
  for (const Bytes& frame : whole) {
    check_decoded(decode_command(frame), frame);
    check_decoded(decode_report(frame), frame);
  }
  // As one frame, with any length fields. encode() cuts lines that are longer than a head's.
  if (size <= max_bins) {
    check_decoded(decode_command(stream), stream);
    check_decoded(decode_report(stream), stream);
  }
  return 0;
}
