// SPDX-License-Identifier: Apache-2.0
// Frames of the Micron's serial line: finds them in a stream of bytes and writes them.
// Source: protocol/micron/README.md 2. There is no checksum and no escaping; only the length marks the end.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_job.hpp"

namespace sonard::micron {

inline constexpr std::uint8_t client_node = 0xFF;
inline constexpr std::uint8_t broadcast_node = 0xFF;  ///< every head accepts frames to it (2.3)
inline constexpr std::uint8_t default_head_node = 2;
inline constexpr std::uint8_t frame_start = 0x40;  ///< '@'
inline constexpr std::uint8_t frame_end = 0x0A;    ///< line feed
inline constexpr std::size_t frame_header_size = 13;
inline constexpr std::size_t min_frame_size = 14;
inline constexpr std::size_t length_overhead = 6;            ///< frame bytes that the length does not count
inline constexpr std::size_t max_command_frame_size = 1006;  ///< limit of a head: length 1000 (2.3)
inline constexpr std::size_t max_report_frame_size = 4096;   ///< limit of a client (2.3)

/// The header of a frame, without start and lengths (2.1). Receivers use only type and nodes, because public
/// drivers send wrong counts.
struct FrameHeader {
  std::uint8_t tx_node = 0;
  std::uint8_t rx_node = 0;
  std::uint8_t count = 0;  ///< bytes from `type` to the end of the data, low 8 bits; 0 in HeadData
  std::uint8_t type = 0;
  std::uint8_t sequence = 0;
  std::uint8_t node = 0;  ///< node of the head, in both directions

  bool operator==(const FrameHeader&) const = default;
};

/// Reads the header of a frame of at least min_frame_size bytes.
FrameHeader frame_header(std::span<const std::uint8_t> frame);

/// Makes one frame with `data`, from a client to the head at `head_node` or from that head to a client.
std::vector<std::uint8_t> frame_to_head(std::uint8_t head_node, std::uint8_t type,
                                        std::span<const std::uint8_t> data);
std::vector<std::uint8_t> frame_from_head(std::uint8_t head_node, std::uint8_t type,
                                          std::span<const std::uint8_t> data);

/// Returns how to continue with `bytes`, the front of a stream (2.3):
///   n > 0  a frame of n bytes starts here
///   n < 0  drop -n bytes: no frame starts in them
///   0      more bytes are needed
/// Drops only the first byte of a false frame, because a true frame may start inside it.
std::ptrdiff_t next_frame(std::span<const std::uint8_t> bytes, std::size_t max_size);

/// Collects a stream, in parts of any size, into frames. Holds less than one frame plus the last part.
/// Not thread-safe; `now` never goes backwards.
class FrameBuffer {
 public:
  struct Frame {
    std::span<const std::uint8_t> bytes;  ///< valid until the next call
    bool cut = false;  ///< shorter than its length, but ended by a line feed and followed by silence (2.4)
  };

  explicit FrameBuffer(std::size_t max_frame_size) : max_frame_size_(max_frame_size) {}

  void append(TimePoint now, std::span<const std::uint8_t> bytes);
  /// The frame in front, after dropping other bytes. It stays in front until pop() or reject().
  std::optional<Frame> front(TimePoint now);
  /// Removes the frame in front.
  void pop();
  /// Removes only the first byte of an invalid frame in front, because a true frame may start inside.
  void reject() { drop(1); }
  void clear();

  /// When front() may find a cut frame; nullopt: only after more bytes.
  std::optional<TimePoint> next_deadline() const;
  /// Bytes outside frames, since construction.
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::span<const std::uint8_t> rest() const { return std::span{bytes_}.subspan(begin_); }
  void drop(std::size_t count);
  void take(std::size_t count);

  std::size_t max_frame_size_;
  std::vector<std::uint8_t> bytes_;
  std::size_t begin_ = 0;       ///< bytes before it have been consumed
  std::size_t front_size_ = 0;  ///< of the frame that front() returned
  TimePoint last_byte_{};
  std::uint64_t dropped_ = 0;
};

}  // namespace sonard::micron
