// SPDX-License-Identifier: Apache-2.0
// Frames of the Micron's serial line: where one begins and ends in a stream of bytes, and how one is written.
// Source: docs/protocols/micron.md 2. There is no checksum and no escaping; only the length tells the end.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_job.hpp"

namespace sonard::micron {

inline constexpr std::uint8_t host_node = 0xFF;
inline constexpr std::uint8_t broadcast_node = 0xFF;  ///< every head takes what is sent to it (2.3)
inline constexpr std::uint8_t default_head_node = 2;
inline constexpr std::uint8_t frame_start = 0x40;  ///< '@'
inline constexpr std::uint8_t frame_end = 0x0A;    ///< line feed
inline constexpr std::size_t frame_header_size = 13;
inline constexpr std::size_t min_frame_size = 14;
inline constexpr std::size_t length_overhead = 6;            ///< frame bytes that the length does not count
inline constexpr std::size_t max_command_frame_size = 1006;  ///< what a head takes: length 1000 (2.3)
inline constexpr std::size_t max_report_frame_size = 4096;   ///< what a host takes (2.3)

/// What stands before the data of a frame, without start and lengths (2.1). Receivers look at type and nodes
/// only: public drivers send wrong counts.
struct FrameHeader {
  std::uint8_t tx_node = 0;
  std::uint8_t rx_node = 0;
  std::uint8_t count = 0;  ///< bytes from `type` to the end of the data, low 8 bits; 0 for lines of a scan
  std::uint8_t type = 0;
  std::uint8_t sequence = 0;
  std::uint8_t node = 0;  ///< the head, in both directions

  bool operator==(const FrameHeader&) const = default;
};

/// The header of a frame of at least min_frame_size bytes.
FrameHeader frame_header(std::span<const std::uint8_t> frame);

/// One frame with `data` in it, from a host to the head at `head_node` and the other way.
std::vector<std::uint8_t> frame_to_head(std::uint8_t head_node, std::uint8_t type,
                                        std::span<const std::uint8_t> data);
std::vector<std::uint8_t> frame_from_head(std::uint8_t head_node, std::uint8_t type,
                                          std::span<const std::uint8_t> data);

/// What to do with `bytes`, the front of a stream (2.3):
///   n > 0  a frame of n bytes starts here
///   n < 0  drop -n bytes: they start no frame
///   0      more bytes are needed
/// Drops one byte of what looks like a frame and is none: a true frame may start inside.
std::ptrdiff_t next_frame(std::span<const std::uint8_t> bytes, std::size_t max_size);

/// Gathers a stream, in pieces of any size, into frames. Holds less than one frame and what came with its
/// last piece. Not thread-safe; `now` never goes backwards.
class FrameBuffer {
 public:
  struct Frame {
    std::span<const std::uint8_t> bytes;  ///< valid until the next call
    bool cut = false;  ///< shorter than it says, but ended by a line feed and followed by silence (2.4)
  };

  explicit FrameBuffer(std::size_t max_frame_size) : max_frame_size_(max_frame_size) {}

  void append(TimePoint now, std::span<const std::uint8_t> bytes);
  /// The frame in front, after dropping what is none. Stays in front until pop() or reject().
  std::optional<Frame> front(TimePoint now);
  /// The frame in front is dealt with.
  void pop();
  /// The frame in front means nothing: only its first byte goes, for a true frame may start inside.
  void reject() { drop(1); }
  void clear();

  /// When front() may find a frame that was cut; nullopt: only after more bytes.
  std::optional<TimePoint> next_deadline() const;
  /// Bytes that were part of no frame, since construction.
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::span<const std::uint8_t> rest() const { return std::span{bytes_}.subspan(begin_); }
  void drop(std::size_t count);
  void take(std::size_t count);

  std::size_t max_frame_size_;
  std::vector<std::uint8_t> bytes_;
  std::size_t begin_ = 0;       ///< bytes before it are done with
  std::size_t front_size_ = 0;  ///< of the frame that front() gave
  TimePoint last_byte_{};
  std::uint64_t dropped_ = 0;
};

}  // namespace sonard::micron
