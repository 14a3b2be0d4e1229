// SPDX-License-Identifier: Apache-2.0
// A fuzz input read as a sequence of events on a time line, for programs that drive a state machine.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/byte_reader.hpp"

namespace sonard::fuzz {

/// One event: bits 2..0 of its first byte are `kind`; the second byte is the time since the last event,
/// squared, in units of 0.1 ms, so that both the time between two lines and a long silence are within reach.
/// Events of a kind below `datagram_kinds` continue with a u16 length and a datagram, which the end of the
/// input may cut short.
struct Event {
  int kind = 0;
  /// Bit 7 of the first byte: the datagram is sent unchanged. Otherwise the program first makes it acceptable
  /// to the other end, so that few mutations are dropped.
  bool as_is = false;
  std::chrono::nanoseconds delay{};
  std::vector<std::uint8_t> datagram;  ///< a copy of exactly its length: sanitizers see a read beyond it
};

class Script {
 public:
  Script(std::span<const std::uint8_t> input, int datagram_kinds)
      : reader_(input), datagram_kinds_(datagram_kinds) {}

  bool done() const { return reader_.remaining() == 0; }

  Event next() {
    const std::uint8_t first = reader_.u8("kind");
    const std::uint8_t time = reader_.remaining() > 0 ? reader_.u8("delay") : std::uint8_t{0};
    Event event;
    event.kind = first & 7;
    event.as_is = (first & 0x80) != 0;
    event.delay = std::chrono::microseconds{100} * time * time;
    if (event.kind < datagram_kinds_ && reader_.remaining() >= 2) {
      const std::size_t length = std::min<std::size_t>(reader_.u16le("length"), reader_.remaining());
      const auto bytes = reader_.bytes(length, "datagram");
      event.datagram.assign(bytes.begin(), bytes.end());
    }
    return event;
  }

 private:
  ByteReader reader_;
  int datagram_kinds_;
};

/// Puts the ID of a Gemini head into the header of a datagram.
inline void address_to_gemini(Event& event, std::uint16_t sonar_id) {
  if (!event.as_is && event.datagram.size() >= 4) {
    event.datagram[2] = static_cast<std::uint8_t>(sonar_id);
    event.datagram[3] = static_cast<std::uint8_t>(sonar_id >> 8);
  }
}

}  // namespace sonard::fuzz
