// SPDX-License-Identifier: Apache-2.0
// One direction of a serial line: an item comes out when its last byte would have arrived.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <ratio>
#include <utility>

#include "server/clock/clock.hpp"

namespace sonard::server {

/// Items keep their order and come out whole. A byte takes ten bits (start bit, 8 data bits, no parity, stop
/// bit), and begins when the one before it has ended. So an item of n bytes on an idle line comes out after n
/// * 10 / baud seconds: 22 bytes at 115200 baud take 1.9 ms. Without a speed it comes out at once.
///
/// Pure: time is an argument, and must not go backwards.
template <typename Item>
class LinePacer {
 public:
  /// @param baud bits per second; 0: infinitely fast
  /// @param most_bytes limit of the bytes in transit; items beyond it are refused
  LinePacer(int baud, std::size_t most_bytes) : baud_(baud), most_bytes_(most_bytes) {}

  /// @param size of the item on the line, in bytes; 0 for an event between bytes
  /// @return false if the item was refused
  bool push(TimePoint now, Item item, std::size_t size) {
    if (size > most_bytes_ - bytes_) {
      return false;
    }
    busy_until_ = std::max(now, busy_until_) + duration_of(size);
    bytes_ += size;
    queue_.push_back({busy_until_, size, std::move(item)});
    return true;
  }

  /// The next item that has arrived by `now`.
  std::optional<Item> pop_due(TimePoint now) {
    if (queue_.empty() || queue_.front().due > now) {
      return std::nullopt;
    }
    Item item = std::move(queue_.front().item);
    bytes_ -= queue_.front().size;
    queue_.pop_front();
    return item;
  }

  std::optional<TimePoint> next_due() const {
    return queue_.empty() ? std::nullopt : std::optional{queue_.front().due};
  }

  /// Drops all items in transit; the line is then idle.
  void clear() {
    queue_.clear();
    bytes_ = 0;
    busy_until_ = {};
  }

  std::size_t waiting() const { return queue_.size(); }

 private:
  struct Entry {
    TimePoint due;
    std::size_t size;
    Item item;
  };

  TimePoint duration_of(std::size_t size) const {
    if (baud_ == 0) {
      return TimePoint{0};
    }
    const std::int64_t bits = static_cast<std::int64_t>(size) * 10;
    return TimePoint{(bits * std::nano::den + baud_ - 1) / baud_};  // rounded up: never early
  }

  int baud_;
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  TimePoint busy_until_{0};
  std::deque<Entry> queue_;
};

}  // namespace sonard::server
