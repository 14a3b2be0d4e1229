// SPDX-License-Identifier: Apache-2.0
// What spreading and absorption leave of an echo.
#pragma once

#include <vector>

#include "renderer/ping.hpp"

namespace sonard::render {

/// Spherical spreading and absorption, two ways, of every range bin (docs/physics.md 2.1, equation 1).
struct TransmissionLoss {
  double step_m = 0.0;
  double absorption_db_per_m = 0.0;
  std::vector<float> of_line;

  TransmissionLoss() = default;
  explicit TransmissionLoss(const SonarSettings& settings);
  /// True: made from these settings.
  bool fits(const SonarSettings& settings) const;
};

/// @param loss of the lines of the image
void apply_loss(const std::vector<float>& loss, EchoImage& image);

}  // namespace sonard::render
