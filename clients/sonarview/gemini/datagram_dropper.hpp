// SPDX-License-Identifier: Apache-2.0
// Loses datagrams on purpose, to see how head and topside take it.
#pragma once

#include <cstdint>
#include <random>

namespace sonard::client {

/// One direction of a lossy link; the same seed loses the same datagrams of a sequence.
class DatagramDropper {
 public:
  /// `probability` 0..1; `direction` keeps the two directions of one seed apart.
  DatagramDropper(double probability, std::uint64_t seed, std::uint64_t direction);

  /// Whether the next datagram is lost.
  bool drop();

  std::uint64_t dropped() const { return dropped_; }

 private:
  std::mt19937_64 random_;
  double probability_;
  std::uint64_t dropped_ = 0;
};

}  // namespace sonard::client
