// SPDX-License-Identifier: Apache-2.0
// Normal noise that is the same on every machine for the same seed.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace sonard {

class Noise {
 public:
  explicit Noise(std::uint64_t seed) : bits_(seed) {}

  /// Mean 0, standard deviation 1 (Box and Muller).
  double next() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }  // [0, 1)

  std::mt19937_64 bits_;
};

}  // namespace sonard
