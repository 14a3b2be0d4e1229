// SPDX-License-Identifier: Apache-2.0
// Drops datagrams on purpose, to test head and client on a lossy link.
#pragma once

#include <cstdint>
#include <random>

namespace sonard::client {

/// One direction of a lossy link. The same seed drops the same datagrams of a sequence.
class DatagramDropper {
 public:
  /// @param probability 0..1
  /// @param direction gives the two directions of a link different random numbers for the same seed
  DatagramDropper(double probability, std::uint64_t seed, std::uint64_t direction);

  /// Whether to drop the next datagram.
  bool drop();

  std::uint64_t dropped() const { return dropped_; }

 private:
  std::mt19937_64 random_;
  double probability_;
  std::uint64_t dropped_ = 0;
};

}  // namespace sonard::client
