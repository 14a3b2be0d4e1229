// SPDX-License-Identifier: Apache-2.0
#include "protocol/oculus/client.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "protocol/oculus/codec.hpp"
#include "protocol/oculus/frame.hpp"

namespace sonard::oculus {
namespace {

constexpr std::array<std::uint8_t, 2> start{oculus_id & 0xFF, oculus_id >> 8};

}  // namespace

void Client::connected() {
  bytes_.clear();
  last_ping_id_.reset();
}

std::optional<std::size_t> Client::front_size() {
  while (true) {
    auto begin = std::search(bytes_.begin(), bytes_.end(), start.begin(), start.end());
    if (begin == bytes_.end() && !bytes_.empty() && bytes_.back() == start[0]) {
      --begin;  // this may be the first half of a start
    }
    statistics_.dropped_bytes += static_cast<std::uint64_t>(begin - bytes_.begin());
    bytes_.erase(bytes_.begin(), begin);
    if (bytes_.size() < header_size) {
      return std::nullopt;
    }
    const std::size_t size = header_size + read_header(bytes_).payload_size;
    if (size <= most_message_size) {
      return size <= bytes_.size() ? std::optional(size) : std::nullopt;
    }
    statistics_.dropped_bytes += start.size();
    bytes_.erase(bytes_.begin(), bytes_.begin() + start.size());
  }
}

void Client::receive(TimePoint now, std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  while (const std::optional<std::size_t> size = front_size()) {
    const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(*size);
    take(now, {bytes_.begin(), end});
    bytes_.erase(bytes_.begin(), end);
  }
}

void Client::take(TimePoint now, std::vector<std::uint8_t> message) {
  ++statistics_.messages;
  const Header header = read_header(message);
  if (header.id == MessageId::dummy) {
    ++statistics_.dummies;
  } else if (header.id == MessageId::logs) {
    logs_.emplace_back(message.begin() + header_size, message.end());
  } else if (header.id == MessageId::simple_ping_result) {
    ReceivedPing ping{now, {}, SharedBytes(std::move(message))};
    auto result = decode_ping_result(ping.message);
    if (!result) {
      ++statistics_.bad_messages;
      return;
    }
    ping.result = std::move(*result);
    const std::uint32_t id = ping.result.ping_id;
    statistics_.pings_missed += last_ping_id_ ? id - *last_ping_id_ - 1 : 0;
    last_ping_id_ = id;
    ++statistics_.pings;
    pings_.push_back(std::move(ping));
  }
}

std::vector<ReceivedPing> Client::take_pings() {
  return std::exchange(pings_, {});
}

std::vector<std::string> Client::take_logs() {
  return std::exchange(logs_, {});
}

}  // namespace sonard::oculus
