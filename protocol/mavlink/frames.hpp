// SPDX-License-Identifier: Apache-2.0
// Frames of MAVLink 1 and 2 in a datagram (MAVLink guide, "Packet Serialization").
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "protocol/mavlink/message_kinds.hpp"

namespace sonard::mavlink {

/// One message as sent.
struct Frame {
  int version = 2;  ///< 1 or 2
  std::uint8_t sequence = 0;
  std::uint8_t system_id = 0;
  std::uint8_t component_id = 0;
  std::uint32_t message_id = 0;
  /// nullptr for an unknown message, whose checksum is not checked.
  const MessageKind* kind = nullptr;
  /// Views the datagram. In version 2, zeros at its end are cut off.
  std::span<const std::uint8_t> payload;
};

/// Counters. They only grow.
struct FrameCounters {
  std::uint64_t frames = 0;         ///< returned, known or not
  std::uint64_t bad_checksums = 0;  ///< of known messages
  std::uint64_t unknown_flags = 0;  ///< version 2 with an incompatible feature other than a signature
  std::uint64_t stray_bytes = 0;    ///< not part of a frame
};

/// Returns the frames of a datagram in order. Skips other bytes one by one until a frame begins, so that a
/// broken frame does not affect its neighbours. The checksum of an unknown message cannot be checked: it
/// counts as a frame if it ends at the end of the datagram or before another magic byte. Signatures are not
/// checked: they need a key, and a pose is not a command.
///
/// Frames are not joined across datagrams, because UDP senders do not split them.
class FrameReader {
 public:
  /// Views `datagram`. `counters` must outlive the reader.
  FrameReader(std::span<const std::uint8_t> datagram, FrameCounters& counters)
      : rest_(datagram), counters_(counters) {}

  /// The next frame; nullopt at the end of the datagram.
  std::optional<Frame> next();

 private:
  std::span<const std::uint8_t> rest_;
  FrameCounters& counters_;
};

}  // namespace sonard::mavlink
