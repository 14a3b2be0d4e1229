// SPDX-License-Identifier: Apache-2.0
// A client's estimate of the clock of a head.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

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
    behind_[next_] = now - std::chrono::microseconds{head_us};
    next_ = (next_ + 1) % behind_.size();
    count_ = std::min(count_ + 1, behind_.size());
  }

  /// Drops all stamps, after a restart of the head.
  void forget() { count_ = next_ = 0; }

  /// Lower bound of the head's clock at `now` in microseconds; 0 before the first stamp.
  std::uint64_t at_least_us(std::chrono::nanoseconds now) const {
    if (count_ == 0) {
      return 0;
    }
    const auto least =
        now - *std::min_element(behind_.begin(), behind_.begin() + static_cast<long>(count_)) - slack;
    return least.count() <= 0 ? 0 : static_cast<std::uint64_t>(least / std::chrono::microseconds{1});
  }

 private:
  /// Two crystals drift apart by less than 2 ms over the seconds that the samples span.
  static constexpr std::chrono::nanoseconds slack = std::chrono::milliseconds{2};

  /// 100 years, which still fits in nanoseconds.
  static constexpr std::uint64_t most_us = 3'153'600'000'000'000;

  std::array<std::chrono::nanoseconds, 8> behind_{};  ///< client time less head time, ring
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace sonard::gemini
