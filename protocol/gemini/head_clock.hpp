// SPDX-License-Identifier: Apache-2.0
// What a topside knows of the clock of a head.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace sonard::gemini {

/// Turns the topside's time into the least time that the clock of the head can show, from stamped datagrams:
/// a stamp is never younger than its arrival. Tells a ping that was transmitted before a configuration left
/// from one that answers it, however late it arrives.
class HeadClock {
 public:
  /// A datagram stamped `head_us` arrived at `now`. Only the newest few count, so that slow drift cannot add
  /// up. Stamps that no clock of a head reaches are ignored.
  void observe(std::chrono::nanoseconds now, std::uint64_t head_us) {
    if (head_us > most_us) {
      return;
    }
    behind_[next_] = now - std::chrono::microseconds{head_us};
    next_ = (next_ + 1) % behind_.size();
    count_ = std::min(count_ + 1, behind_.size());
  }

  /// The head was started again; its old stamps mean nothing.
  void forget() { count_ = next_ = 0; }

  /// The clock of the head shows at least this at `now`, in microseconds; 0 while nothing is known.
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

  /// A hundred years, which nanoseconds can still hold.
  static constexpr std::uint64_t most_us = 3'153'600'000'000'000;

  std::array<std::chrono::nanoseconds, 8> behind_{};  ///< topside time less head time, ring
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace sonard::gemini
