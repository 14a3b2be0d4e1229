// SPDX-License-Identifier: Apache-2.0
// Frames of the Ping protocol: where one begins and ends in a stream of bytes, and how one is written.
// Source: docs/protocols/ping360.md 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_job.hpp"

namespace sonard::ping360 {

inline constexpr std::uint8_t frame_start_1 = 0x42;  ///< 'B'
inline constexpr std::uint8_t frame_start_2 = 0x52;  ///< 'R'
inline constexpr std::size_t frame_header_size = 8;
inline constexpr std::size_t checksum_size = 2;
inline constexpr std::size_t frame_overhead = frame_header_size + checksum_size;
inline constexpr std::size_t max_payload_size = 4096;  ///< what is longer is no frame (1.1)
inline constexpr std::uint8_t default_device_id = 2;   ///< of the head
inline constexpr std::uint8_t host_id = 0;             ///< of every known client
inline constexpr std::uint8_t broadcast_id = 255;
inline constexpr std::uint8_t baud_byte = 0x55;  ///< 'U', by which a serial head finds the speed of its line

/// What stands before the payload of a frame, without the start bytes.
struct FrameHeader {
  std::uint16_t payload_length = 0;
  std::uint16_t message_id = 0;
  std::uint8_t source = 0;
  std::uint8_t destination = 0;

  bool operator==(const FrameHeader&) const = default;
};

/// The header of a frame of at least frame_header_size bytes.
FrameHeader frame_header(std::span<const std::uint8_t> frame);

/// One frame with `payload` in it, of at most max_payload_size bytes.
std::vector<std::uint8_t> make_frame(std::uint16_t message_id, std::uint8_t source, std::uint8_t destination,
                                     std::span<const std::uint8_t> payload);

/// What to do with `bytes`, the front of a stream (1.1):
///   n > 0  a frame of n bytes with a right checksum starts here
///   n < 0  drop -n bytes: they start no frame
///   0      more bytes are needed
/// Of what looks like a frame and is none, one byte is dropped: a true frame may start inside.
std::ptrdiff_t next_frame(std::span<const std::uint8_t> bytes);

/// Gathers the bytes of one client, in pieces of any size, into frames. Holds less than one frame and what
/// came with its last piece. Not thread-safe; `now` never goes backwards.
class FrameBuffer {
 public:
  /// What has stopped to come for 100 ms will not go on: a length that noise has made hides no frame for
  /// longer than that.
  void append(TimePoint now, std::span<const std::uint8_t> bytes);
  /// The frame in front, after dropping what is none; valid until the next call. Stays until pop().
  std::optional<std::span<const std::uint8_t>> front();
  /// The frame in front is dealt with.
  void pop();
  /// What has begun will not be finished.
  void clear();

  /// Whether baud bytes stood before the frame in front, or after the last one, since the last call. Those
  /// inside of a broken frame do not count.
  bool take_baud_bytes();
  /// Bytes that were part of no frame, since construction.
  std::uint64_t dropped() const { return dropped_; }
  /// Frames whose checksum was wrong, since construction.
  std::uint64_t bad_checksums() const { return bad_checksums_; }

 private:
  std::span<const std::uint8_t> rest() const { return std::span{bytes_}.subspan(begin_); }
  void drop(std::size_t count);
  void note_broken_frame();

  std::vector<std::uint8_t> bytes_;
  std::size_t begin_ = 0;       ///< bytes before it are done with
  std::size_t front_size_ = 0;  ///< of the frame that front() gave
  std::size_t broken_ = 0;      ///< bytes from `begin_` on that belong to a broken frame
  bool baud_bytes_ = false;
  TimePoint last_byte_{};
  std::uint64_t dropped_ = 0;
  std::uint64_t bad_checksums_ = 0;
};

}  // namespace sonard::ping360
