// How one sample's echo spreads over range lines: the convolution of two boxes (docs/physics.md 2.3).
#pragma once

#include <algorithm>

namespace sonard::render {

/// A pixel covers a span of ranges, not one range. Across a plane the span is the sum of two independent
/// uniform spreads, one along each pixel side: a trapezoid of base width a + b. All lengths are in range
/// lines.
struct Footprint {
  float rise_from;  ///< lower end of the base
  float minor;      ///< width of each ramp, the smaller of a and b
  float plateau;    ///< width of the flat top, the difference of a and b
  float ramp_gain;  ///< 1 / (2 a b)
  float flat_gain;  ///< 1 / max(a, b)

  /// @param centre position of the sample; @param a, b spreads >= 0; both are raised to `least` to avoid
  /// divisions by zero, which moves no more than `least` of a line.
  static Footprint make(float centre, float a, float b) {
    const float major = std::clamp(std::max(a, b), least, widest);
    const float minor = std::clamp(std::min(a, b), least, widest);
    return {centre - 0.5F * (major + minor), minor, major - minor, 0.5F / (major * minor), 1.0F / major};
  }

  float base() const { return 2 * minor + plateau; }

  /// Fraction of the echo below `edge`: 0 ... 1. Built from distances clamped to each of the three pieces, so
  /// it has no branches and no cancellation where one spread is far smaller than the other.
  float below(float edge) const {
    const float rise = std::clamp(edge - rise_from, 0.0F, minor);
    const float flat = std::clamp(edge - rise_from - minor, 0.0F, plateau);
    const float fall = std::clamp(edge - rise_from - minor - plateau, 0.0F, minor);
    return rise * rise * ramp_gain + flat * flat_gain + fall * (2 * minor - fall) * ramp_gain;
  }

  static constexpr float least = 1e-3F;    ///< spreads below this are points
  static constexpr float widest = 512.0F;  ///< spreads are cut here: surfaces seen edge-on carry no energy
};

}  // namespace sonard::render
