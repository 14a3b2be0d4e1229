// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/slices/elevation_pattern.hpp"

#include <cmath>

namespace sonard::render {

ElevationPattern::ElevationPattern(const Aperture& aperture, bool tabled_if_flat)
    : tan_limit_(static_cast<float>(std::tan(aperture.elevation_limit_rad()))),
      varies_(aperture.elevation != Aperture::Elevation::top_hat) {
  if (!varies_ && !tabled_if_flat) {
    return;
  }
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(tan_limit_) * (2.0 * i / steps - 1);
    weight_.push_back(static_cast<float>(aperture.elevation_weight(std::atan(t))));
  }
}

}  // namespace sonard::render
