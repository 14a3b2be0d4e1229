// SPDX-License-Identifier: Apache-2.0
// Any bytes as a datagram of MAVLink frames.
// Promises: frames lie inside the datagram, and no byte counts twice; a known message has its checksum; every
// message decodes or is too short for version 1.
#include <cstdint>
#include <span>

#include "protocol/mavlink/checksum.hpp"
#include "protocol/mavlink/messages.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace sonard::mavlink;
using sonard::fuzz::require;

void check_frame(const Frame& frame, std::span<const std::uint8_t> datagram) {
  const std::size_t header = frame.version == 2 ? 10 : 6;
  const auto begin = static_cast<std::size_t>(frame.payload.data() - datagram.data());
  require(begin >= header && begin + frame.payload.size() + 2 <= datagram.size(), "a frame lies inside");
  if (frame.kind != nullptr) {
    const auto checked = datagram.subspan(begin - header + 1, header - 1 + frame.payload.size());
    const std::size_t end = begin + frame.payload.size();
    require(checksum(checked, frame.kind->seed) == (datagram[end] | datagram[end + 1] << 8),
            "a known message has its checksum");
  }
  const auto message = decode(frame);
  require(message.has_value() || frame.version == 1, "version 2 is never too short");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span datagram{data, size};
  FrameCounters counters;
  FrameReader reader(datagram, counters);
  std::uint64_t frames = 0;
  std::size_t in_frames = 0;
  while (const auto frame = reader.next()) {
    check_frame(*frame, datagram);
    ++frames;
    in_frames += (frame->version == 2 ? 12U : 8U) + frame->payload.size();
  }
  require(frames == counters.frames, "every frame is counted");
  require(in_frames + counters.stray_bytes <= size, "no byte is counted twice");
  require(counters.bad_checksums + counters.unknown_flags <= counters.stray_bytes, "what is broken is stray");
  require(frames > 0 || counters.stray_bytes == size, "without a frame all bytes are stray");
  return 0;
}
