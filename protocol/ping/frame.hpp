// SPDX-License-Identifier: Apache-2.0
// Frames of the Ping protocol: finds them in a stream of bytes and writes them.
// Source: protocol/ping360/README.md 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_job.hpp"

namespace sonard::ping {

inline constexpr std::uint8_t frame_start_1 = 0x42;  ///< 'B'
inline constexpr std::uint8_t frame_start_2 = 0x52;  ///< 'R'
inline constexpr std::size_t frame_header_size = 8;
inline constexpr std::size_t checksum_size = 2;
inline constexpr std::size_t frame_overhead = frame_header_size + checksum_size;
inline constexpr std::size_t max_payload_size = 4096;  ///< a longer one is not a frame (1.1)
inline constexpr std::uint8_t client_id = 0;           ///< of every known client
inline constexpr std::uint8_t broadcast_id = 255;
inline constexpr std::uint8_t baud_byte = 0x55;  ///< 'U', with which a serial head detects the baud rate

/// The header of a frame, without the start bytes.
struct FrameHeader {
  std::uint16_t payload_length = 0;
  std::uint16_t message_id = 0;
  std::uint8_t source = 0;
  std::uint8_t destination = 0;

  bool operator==(const FrameHeader&) const = default;
};

/// Reads the header of a frame of at least frame_header_size bytes.
FrameHeader frame_header(std::span<const std::uint8_t> frame);

/// Makes one frame with `payload`, at most max_payload_size bytes.
std::vector<std::uint8_t> make_frame(std::uint16_t message_id, std::uint8_t source, std::uint8_t destination,
                                     std::span<const std::uint8_t> payload);

/// Returns how to continue with `bytes`, the front of a stream (1.1):
///   n > 0  a frame of n bytes with a correct checksum starts here
///   n < 0  drop -n bytes: no frame starts in them
///   0      more bytes are needed
/// Drops only the first byte of a false frame, because a true frame may start inside it.
std::ptrdiff_t next_frame(std::span<const std::uint8_t> bytes, std::size_t max_payload = max_payload_size);

/// Collects the bytes of one client, in parts of any size, into frames. Holds less than one frame plus the
/// last part. Not thread-safe; `now` never goes backwards.
class FrameBuffer {
 public:
  /// A longer payload than `max_payload` is not a frame. With a small one, a false length hides few frames.
  explicit FrameBuffer(std::size_t max_payload = max_payload_size) : max_payload_(max_payload) {}

  /// Adds bytes. Drops an unfinished frame after a gap of 100 ms, so that a false length caused by noise
  /// cannot hide frames for longer.
  void append(TimePoint now, std::span<const std::uint8_t> bytes);
  /// The frame in front, after dropping other bytes; valid until the next call. It stays in front until
  /// pop().
  std::optional<std::span<const std::uint8_t>> front();
  /// Removes the frame in front.
  void pop();
  /// Drops an unfinished frame.
  void clear();

  /// True if baud bytes came before the frame in front, or after the last one, since the last call. Baud
  /// bytes inside a broken frame do not count.
  bool take_baud_bytes();
  /// Bytes outside frames, since construction.
  std::uint64_t dropped() const { return dropped_; }
  /// Frames with a wrong checksum, since construction.
  std::uint64_t bad_checksums() const { return bad_checksums_; }

 private:
  std::span<const std::uint8_t> rest() const { return std::span{bytes_}.subspan(begin_); }
  void drop(std::size_t count);
  void note_broken_frame();

  std::size_t max_payload_;
  std::vector<std::uint8_t> bytes_;
  std::size_t begin_ = 0;       ///< bytes before it have been consumed
  std::size_t front_size_ = 0;  ///< of the frame that front() returned
  std::size_t broken_ = 0;      ///< bytes from `begin_` on that belong to a broken frame
  bool baud_bytes_ = false;
  TimePoint last_byte_{};
  std::uint64_t dropped_ = 0;
  std::uint64_t bad_checksums_ = 0;
};

}  // namespace sonard::ping
