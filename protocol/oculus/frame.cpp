// SPDX-License-Identifier: Apache-2.0
#include "protocol/oculus/frame.hpp"

#include <algorithm>

#include "protocol/oculus/layout.hpp"

namespace sonard::oculus {
namespace {

constexpr std::uint8_t first_start = oculus_id & 0xFF;
constexpr std::uint8_t second_start = oculus_id >> 8;

/// Number of bytes before a message start. The last byte is kept if it may be the first half of a start.
std::size_t before_start(std::span<const std::uint8_t> bytes) {
  std::size_t count = 0;
  while (count < bytes.size() &&
         (bytes[count] != first_start || (count + 1 < bytes.size() && bytes[count + 1] != second_start))) {
    ++count;
  }
  return count;
}

}  // namespace

Header read_header(std::span<const std::uint8_t> message) {
  ByteReader reader(message);
  Header header;
  read_fields<HeaderLayout>(reader, header);
  return header;
}

std::size_t command_payload_size(const Header& header) {
  if (header.payload_size != 0) {
    return header.payload_size;
  }
  switch (header.id) {
    case MessageId::simple_fire:
      return (header.version == 2 ? fire_v2_size : fire_v1_size) - header_size;
    case MessageId::user_config:
      return user_config_size - header_size;
    default:
      return 0;
  }
}

void CommandBuffer::append(std::span<const std::uint8_t> bytes) {
  if (broken_) {
    return;
  }
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<std::span<const std::uint8_t>> CommandBuffer::front() {
  drop_to_start();
  if (broken_ || rest().size() < header_size) {
    return std::nullopt;
  }
  const std::size_t payload = command_payload_size(read_header(rest()));
  if (payload > most_command_payload) {
    clear();
    broken_ = true;
    return std::nullopt;
  }
  if (rest().size() < header_size + payload) {
    return std::nullopt;
  }
  front_size_ = header_size + payload;
  return rest().first(front_size_);
}

void CommandBuffer::pop() {
  begin_ += front_size_;
  front_size_ = 0;
}

void CommandBuffer::clear() {
  bytes_.clear();
  begin_ = 0;
  front_size_ = 0;
  broken_ = false;
}

void CommandBuffer::drop_to_start() {
  const std::size_t count = before_start(rest());
  begin_ += count;
  dropped_ += count;
}

}  // namespace sonard::oculus
