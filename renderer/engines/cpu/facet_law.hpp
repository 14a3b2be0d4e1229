// SPDX-License-Identifier: Apache-2.0
// Backscatter::facets() for loops that are compiled to vector instructions.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace sonard::render {

/// exp(x) for x from -80 to 0, accurate to 2e-7; a call of std::exp() would prevent vectorisation.
inline float exp_of_negative(float x) {
  const float y = x * 1.44269504F;
  const auto whole = static_cast<std::int32_t>(y - 0.5F);
  const float z = (y - static_cast<float>(whole)) * 0.69314718F;  // from -ln 2 / 2 to ln 2 / 2
  const float series =
      1 + z * (1 + z * (0.5F + z * (1.0F / 6 + z * (1.0F / 24 + z * (1.0F / 120 + z * (1.0F / 720))))));
  return series * std::bit_cast<float>((whole + 127) << 23);
}

/// Backscatter::facets() as a function of the squared cosine, without branches. A negligible response is
/// 1e-25, also for NaN.
/// @param variance at most Backscatter::widest_variance
inline float facet_law(float c2, float strength, float variance) {
  constexpr float grazing = 1e-4F, as_good_as_none = 80.0F;
  const float k2 = c2 > grazing ? (c2 < 1 ? c2 : 1.0F) : grazing;
  const float exponent = (1 - k2) / (2 * variance * k2);
  return strength / (variance * k2 * k2 * std::sqrt(k2)) *
         exp_of_negative(exponent < as_good_as_none ? -exponent : -as_good_as_none);
}

}  // namespace sonard::render
