// SPDX-License-Identifier: Apache-2.0
// Where one turn of a scan ends and the next begins.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/ping360/host.hpp"

namespace sonard::client {

/// Once round, or in a sector once from one end to the other.
struct Sweep360 {
  std::uint64_t number = 0;  ///< 0, 1, 2, ...
  std::vector<ping360::ReceivedPing> pings;
};

/// What a screen shows in the middle of a turn: behind the pings of `before` at angles that `sweep` has not
/// come to, those of `sweep`.
Sweep360 with_pings_before(Sweep360 sweep, const std::optional<Sweep360>& before);

/// Sorts pings into turns by their angles alone: a turn ends where the head has come round, or turns back.
class SweepCollector {
 public:
  explicit SweepCollector(bool all_round) : all_round_(all_round) {}

  /// The next ping. Returns the turn that was complete before it.
  std::optional<Sweep360> add(const ping360::ReceivedPing& ping);
  const Sweep360& current() const { return current_; }

 private:
  bool all_round_;
  Sweep360 current_;
  std::optional<int> last_;  ///< angle
  int way_ = 0;              ///< from the first ping of the turn to the last, gradians, clockwise
};

}  // namespace sonard::client
