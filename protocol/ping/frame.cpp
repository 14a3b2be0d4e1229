// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping/frame.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <utility>

#include "protocol/common/byte_writer.hpp"

namespace sonard::ping {
namespace {

constexpr std::chrono::milliseconds give_up_silence{100};
constexpr std::size_t length_end = 4;

std::uint16_t u16le(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return static_cast<std::uint16_t>(bytes[offset] | bytes[offset + 1] << 8);
}

std::uint16_t checksum(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint16_t>(std::accumulate(bytes.begin(), bytes.end(), 0U));
}

}  // namespace

FrameHeader frame_header(std::span<const std::uint8_t> frame) {
  return {.payload_length = u16le(frame, 2),
          .message_id = u16le(frame, 4),
          .source = frame[6],
          .destination = frame[7]};
}

std::vector<std::uint8_t> make_frame(std::uint16_t message_id, std::uint8_t source, std::uint8_t destination,
                                     std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> frame;
  frame.reserve(payload.size() + frame_overhead);
  ByteWriter writer{frame};
  writer.u8(frame_start_1);
  writer.u8(frame_start_2);
  writer.u16le(static_cast<std::uint16_t>(payload.size()));
  writer.u16le(message_id);
  writer.u8(source);
  writer.u8(destination);
  writer.bytes(payload);
  writer.u16le(checksum(frame));
  return frame;
}

std::ptrdiff_t next_frame(std::span<const std::uint8_t> bytes, std::size_t max_payload) {
  const auto start = std::ranges::find(bytes, frame_start_1) - bytes.begin();
  if (start > 0) {
    return -start;
  }
  if (bytes.size() >= 2 && bytes[1] != frame_start_2) {
    return -1;
  }
  if (bytes.size() < length_end) {
    return 0;
  }
  const std::size_t payload_length = u16le(bytes, 2);
  if (payload_length > max_payload) {
    return -1;
  }
  const std::size_t size = payload_length + frame_overhead;
  if (bytes.size() < size) {
    return 0;
  }
  const std::size_t checksum_offset = size - checksum_size;
  const bool right = checksum(bytes.first(checksum_offset)) == u16le(bytes, checksum_offset);
  return right ? static_cast<std::ptrdiff_t>(size) : -1;
}

// ---- FrameBuffer

void FrameBuffer::append(TimePoint now, std::span<const std::uint8_t> bytes) {
  if (now - last_byte_ >= give_up_silence) {
    clear();
  }
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  last_byte_ = now;
}

std::optional<std::span<const std::uint8_t>> FrameBuffer::front() {
  std::ptrdiff_t found = 0;
  while ((found = next_frame(rest(), max_payload_)) < 0) {
    note_broken_frame();
    drop(static_cast<std::size_t>(-found));
  }
  front_size_ = static_cast<std::size_t>(found);
  return found > 0 ? std::optional{rest().first(front_size_)} : std::nullopt;
}

void FrameBuffer::clear() {
  broken_ = rest().size();
  drop(broken_);
}

void FrameBuffer::pop() {
  begin_ += front_size_;
  broken_ -= std::min(broken_, front_size_);
  front_size_ = 0;
}

bool FrameBuffer::take_baud_bytes() {
  return std::exchange(baud_bytes_, false);
}

/// If the bytes have a valid start and length, next_frame() rejected them for a wrong checksum.
void FrameBuffer::note_broken_frame() {
  const auto bytes = rest();
  if (bytes.size() >= length_end && bytes[0] == frame_start_1 && bytes[1] == frame_start_2 &&
      u16le(bytes, 2) <= max_payload_) {
    broken_ = std::max(broken_, u16le(bytes, 2) + frame_overhead);
    ++bad_checksums_;
  }
}

void FrameBuffer::drop(std::size_t count) {
  const auto junk = rest().first(count);
  const auto between = junk.subspan(std::min(broken_, count));
  baud_bytes_ = baud_bytes_ || std::ranges::find(between, baud_byte) != between.end();
  broken_ -= std::min(broken_, count);
  dropped_ += count;
  begin_ += count;
  front_size_ = 0;
}

}  // namespace sonard::ping
