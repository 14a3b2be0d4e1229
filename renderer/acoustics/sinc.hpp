#pragma once

#include <cmath>
#include <numbers>

namespace sonard::render {

/// sin(pi x) / (pi x): what an even band of frequencies is in time.
inline double sinc_at(double x) {
  const double y = std::numbers::pi * x;
  return y == 0 ? 1.0 : std::sin(y) / y;
}

}  // namespace sonard::render
