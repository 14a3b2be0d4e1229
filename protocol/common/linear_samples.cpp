// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/linear_samples.hpp"

#include <array>
#include <cmath>

namespace sonard {

void make_linear(std::span<std::uint8_t> samples, double amplitude_exponent) {
  if (amplitude_exponent == 1.0) {
    return;
  }
  constexpr double full_scale = 255.0;
  std::array<std::uint8_t, 256> amplitudes{};
  for (std::size_t code = 0; code < amplitudes.size(); ++code) {
    const double share = static_cast<double>(code) / full_scale;
    amplitudes[code] =
        static_cast<std::uint8_t>(std::lround(full_scale * std::pow(share, 1.0 / amplitude_exponent)));
  }
  for (std::uint8_t& sample : samples) {
    sample = amplitudes[sample];
  }
}

}  // namespace sonard
