// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/frame.hpp"

#include <algorithm>

#include "protocol/common/byte_writer.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {
namespace {

constexpr std::size_t digits_end = 5;    // start, hexadecimal length
constexpr std::size_t lengths_end = 7;   // start, hexadecimal length, binary length
constexpr std::size_t min_length = 8;    // of a frame without data
constexpr std::size_t count_offset = 5;  // length less count
constexpr std::uint8_t only_packet = 0x80;
constexpr std::chrono::milliseconds cut_silence{100};
// One client sends head commands of 82 bytes with a length for 66 (2.4).
constexpr std::size_t head_command_size = 66;
constexpr std::size_t longer_head_command_size = 82;

std::optional<unsigned> hex_digit(std::uint8_t c) {
  if (c >= '0' && c <= '9') {
    return c - '0';
  }
  if (c >= 'A' && c <= 'F') {
    return c - 'A' + 10;
  }
  if (c >= 'a' && c <= 'f') {
    return c - 'a' + 10;
  }
  return std::nullopt;
}

/// The hexadecimal length; nullopt if it has invalid digits.
std::optional<std::size_t> spelled_length(std::span<const std::uint8_t> bytes) {
  std::size_t length = 0;
  for (const std::uint8_t c : bytes.subspan(1, 4)) {
    const auto digit = hex_digit(c);
    if (!digit) {
      return std::nullopt;
    }
    length = length << 4 | *digit;
  }
  return length;
}

/// The length; nullopt if the hexadecimal and the binary length differ.
std::optional<std::size_t> stated_length(std::span<const std::uint8_t> bytes) {
  const auto length = spelled_length(bytes);
  const std::size_t binary = bytes[5] | static_cast<std::size_t>(bytes[6]) << 8;
  return length == binary ? length : std::nullopt;
}

/// True if the hexadecimal length may have five digits, as one client writes it, so that the binary length
/// follows one byte later (2.4). The result is certain if there are more than lengths_end bytes.
bool has_fifth_digit(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < lengths_end || bytes[0] != frame_start || !hex_digit(bytes[digits_end])) {
    return false;
  }
  const auto length = spelled_length(bytes);
  return length && bytes[digits_end + 1] == (*length & 0xFF) &&
         (bytes.size() == lengths_end || bytes[digits_end + 2] == *length >> 8);
}

std::vector<std::uint8_t> make_frame(const FrameHeader& header, std::span<const std::uint8_t> data) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  const std::size_t length = data.size() + min_length;
  std::vector<std::uint8_t> frame;
  frame.reserve(length + length_overhead);
  ByteWriter writer{frame};
  writer.u8(frame_start);
  for (const unsigned shift : {12U, 8U, 4U, 0U}) {
    writer.u8(static_cast<std::uint8_t>(digits[length >> shift & 0xF]));
  }
  writer.u16le(static_cast<std::uint16_t>(length));
  writer.u8(header.tx_node);
  writer.u8(header.rx_node);
  writer.u8(header.type == static_cast<std::uint8_t>(MessageType::head_data)
                ? std::uint8_t{0}
                : static_cast<std::uint8_t>(length - count_offset));
  writer.u8(header.type);
  writer.u8(only_packet);
  writer.u8(header.node);
  writer.bytes(data);
  writer.u8(frame_end);
  return frame;
}

}  // namespace

FrameHeader frame_header(std::span<const std::uint8_t> frame) {
  return {.tx_node = frame[7],
          .rx_node = frame[8],
          .count = frame[9],
          .type = frame[10],
          .sequence = frame[11],
          .node = frame[12]};
}

std::vector<std::uint8_t> frame_to_head(std::uint8_t head_node, std::uint8_t type,
                                        std::span<const std::uint8_t> data) {
  return make_frame({.tx_node = client_node, .rx_node = head_node, .type = type, .node = head_node}, data);
}

std::vector<std::uint8_t> frame_from_head(std::uint8_t head_node, std::uint8_t type,
                                          std::span<const std::uint8_t> data) {
  return make_frame({.tx_node = head_node, .rx_node = client_node, .type = type, .node = head_node}, data);
}

std::ptrdiff_t next_frame(std::span<const std::uint8_t> bytes, std::size_t max_size) {
  const auto start = std::ranges::find(bytes, frame_start) - bytes.begin();
  if (start > 0) {
    return -start;
  }
  if (bytes.size() < lengths_end) {
    return 0;
  }
  const auto length = stated_length(bytes);
  if (!length || *length < min_length || *length + length_overhead > max_size) {
    return -1;
  }
  std::size_t size = *length + length_overhead;
  if (bytes.size() < size) {
    return 0;
  }
  // If the last byte starts a frame, a byte was lost; then this is not the longer command.
  if (size == head_command_size && bytes[size - 1] != frame_end && bytes[size - 1] != frame_start &&
      frame_header(bytes).type == static_cast<std::uint8_t>(MessageType::head_command)) {
    size = longer_head_command_size;
    if (bytes.size() < size) {
      return 0;
    }
  }
  return bytes[size - 1] == frame_end ? static_cast<std::ptrdiff_t>(size) : -1;
}

// ---- FrameBuffer

void FrameBuffer::append(TimePoint now, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) {
    return;
  }
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  last_byte_ = now;
}

std::optional<FrameBuffer::Frame> FrameBuffer::front(TimePoint now) {
  std::ptrdiff_t found = 0;
  while ((found = next_frame(rest(), max_frame_size_)) < 0) {
    if (!has_fifth_digit(rest())) {
      drop(static_cast<std::size_t>(-found));
    } else if (rest().size() == lengths_end) {
      return std::nullopt;  // the next byte decides
    } else {
      bytes_.erase(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_ + digits_end));
      ++dropped_;
    }
  }
  front_size_ = static_cast<std::size_t>(found);
  if (found > 0) {
    return Frame{rest().first(front_size_), false};
  }
  if (const auto deadline = next_deadline(); deadline && now >= *deadline) {
    front_size_ = rest().size();
    return Frame{rest(), true};
  }
  return std::nullopt;
}

void FrameBuffer::pop() {
  take(front_size_);
}

void FrameBuffer::clear() {
  drop(rest().size());
}

std::optional<TimePoint> FrameBuffer::next_deadline() const {
  const auto unfinished = rest();
  if (unfinished.size() < min_frame_size || unfinished.back() != frame_end ||
      next_frame(unfinished, max_frame_size_) != 0) {
    return std::nullopt;
  }
  return last_byte_ + cut_silence;
}

void FrameBuffer::drop(std::size_t count) {
  dropped_ += count;
  take(count);
}

void FrameBuffer::take(std::size_t count) {
  begin_ += count;
  front_size_ = 0;
}

}  // namespace sonard::micron
