// SPDX-License-Identifier: Apache-2.0
// Levels.
#pragma once

#include <cmath>

namespace sonard::render {

/// Intensity of a level in dB (10 log10).
inline double decibels_to_power(double decibels) {
  return std::pow(10.0, decibels / 10);
}

}  // namespace sonard::render
