// SPDX-License-Identifier: Apache-2.0
// A client's estimate of the clock of a head.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace sonard::gemini {

/// Computes the earliest time that the clock of the head can show, from the time stamps of datagrams. A stamp
/// is never newer than its arrival. With this bound the client recognises a ping that was transmitted before
/// the configuration was sent, however late the ping arrives.
class HeadClock {
 public:
  /// Adds a datagram stamped `head_us` that arrived at `now`. Only the newest 8 count, so that slow drift
  /// does not accumulate. Stamps above `most_us` are ignored.
  void observe(std::chrono::nanoseconds now, std::uint64_t head_us) {
    if (head_us > most_us) {
      return;
    }
    behind_.push_back(now - std::chrono::microseconds{head_us});
    if (behind_.size() > kept) {
      behind_.pop_front();
    }
  }

  /// Drops all stamps, after a restart of the head.
  void forget() { behind_.clear(); }

  /// Lower bound of the head's clock at `now` in microseconds; 0 before the first stamp.
  std::uint64_t at_least_us(std::chrono::nanoseconds now) const {
    if (behind_.empty()) {
      return 0;
    }
    const auto least = now - *std::min_element(behind_.begin(), behind_.end()) - slack;
    return least.count() <= 0 ? 0 : static_cast<std::uint64_t>(least / std::chrono::microseconds{1});
  }

 private:
  static constexpr std::size_t kept = 8;
  /// Two crystals drift apart by less than 2 ms over the seconds that the samples span.
  static constexpr std::chrono::nanoseconds slack = std::chrono::milliseconds{2};
  /// 100 years, which still fits in nanoseconds.
  static constexpr std::uint64_t most_us = 3'153'600'000'000'000;

  std::deque<std::chrono::nanoseconds> behind_;  ///< client time less head time
};

}  // namespace sonard::gemini
