// SPDX-License-Identifier: Apache-2.0
// Frames of MAVLink 1 and 2 in a datagram (MAVLink guide, "Packet Serialization").
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "protocol/mavlink/message_kinds.hpp"

namespace sonard::mavlink {

/// One message as it was sent.
struct Frame {
  int version = 2;  ///< 1 or 2
  std::uint8_t sequence = 0;
  std::uint8_t system_id = 0;
  std::uint8_t component_id = 0;
  std::uint32_t message_id = 0;
  /// Nullptr for a message that is not known; its checksum has then not been compared.
  const MessageKind* kind = nullptr;
  /// Into the datagram. Version 2 cuts zeros off its end.
  std::span<const std::uint8_t> payload;
};

/// Counters, which only grow.
struct FrameCounters {
  std::uint64_t frames = 0;         ///< handed out, known or not
  std::uint64_t bad_checksums = 0;  ///< of known messages
  std::uint64_t unknown_flags = 0;  ///< version 2 with an incompatible feature other than a signature
  std::uint64_t stray_bytes = 0;    ///< in no frame
};

/// Hands out the frames of a datagram, front to back. What is no frame is stepped over byte by byte until one
/// begins, so that a broken frame takes none of its neighbours along. A message that is not known cannot be
/// told from stray bytes by its checksum: it counts as a frame when it ends with the datagram or where
/// another one seems to begin. Signatures are not checked: they are keyed, and a pose is not a command.
///
/// Frames are not joined across datagrams; senders by UDP do not part them.
class FrameReader {
 public:
  /// Views `datagram`. `counters` outlives the reader.
  FrameReader(std::span<const std::uint8_t> datagram, FrameCounters& counters)
      : rest_(datagram), counters_(counters) {}

  /// The next frame; nullopt at the end of the datagram.
  std::optional<Frame> next();

 private:
  std::span<const std::uint8_t> rest_;
  FrameCounters& counters_;
};

}  // namespace sonard::mavlink
