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
/// Events of a kind below `datagram_kinds` go on with a u16 length and a datagram, which the end of the input
/// may cut short.
struct Event {
  int kind = 0;
  std::chrono::nanoseconds delay{};
  std::vector<std::uint8_t> datagram;  ///< a copy of exactly its length: sanitizers see a read beyond it
};

class Script {
 public:
  /// Bit 7 of the first byte leaves the sonar ID in the header of the datagram alone; otherwise it becomes
  /// `sonar_id`, so that few mutations are wasted on datagrams for somebody else.
  Script(std::span<const std::uint8_t> input, int datagram_kinds, std::uint16_t sonar_id)
      : reader_(input), datagram_kinds_(datagram_kinds), sonar_id_(sonar_id) {}

  bool done() const { return reader_.remaining() == 0; }

  Event next() {
    const std::uint8_t first = reader_.u8("kind");
    const std::uint8_t time = reader_.remaining() > 0 ? reader_.u8("delay") : std::uint8_t{0};
    Event event;
    event.kind = first & 7;
    event.delay = std::chrono::microseconds{100} * time * time;
    if (event.kind < datagram_kinds_ && reader_.remaining() >= 2) {
      const std::size_t length = std::min<std::size_t>(reader_.u16le("length"), reader_.remaining());
      const auto bytes = reader_.bytes(length, "datagram");
      event.datagram.assign(bytes.begin(), bytes.end());
      if ((first & 0x80) == 0 && event.datagram.size() >= 4) {
        event.datagram[2] = static_cast<std::uint8_t>(sonar_id_);
        event.datagram[3] = static_cast<std::uint8_t>(sonar_id_ >> 8);
      }
    }
    return event;
  }

 private:
  ByteReader reader_;
  int datagram_kinds_;
  std::uint16_t sonar_id_;
};

}  // namespace sonard::fuzz
