// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/datagram_dropper.hpp"

namespace sonard::client {

DatagramDropper::DatagramDropper(double probability, std::uint64_t seed, std::uint64_t direction)
    : random_(2 * seed + direction), probability_(probability) {}

bool DatagramDropper::drop() {
  // Distributions of standard libraries differ; this formula gives the same numbers everywhere.
  const bool lost = static_cast<double>(random_() >> 11) * 0x1p-53 < probability_;
  dropped_ += lost ? 1 : 0;
  return lost;
}

}  // namespace sonard::client
