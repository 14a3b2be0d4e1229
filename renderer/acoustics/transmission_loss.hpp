// SPDX-License-Identifier: Apache-2.0
// Loss of an echo by spreading and absorption.
#pragma once

#include <vector>

#include "renderer/ping.hpp"

namespace sonard::render {

/// Two-way spherical spreading and absorption per range bin (docs/physics.md 2.1, equation 1).
struct TransmissionLoss {
  double step_m = 0.0;
  double absorption_db_per_m = 0.0;
  std::vector<float> of_line;

  TransmissionLoss() = default;
  explicit TransmissionLoss(const SonarSettings& settings);
  /// True if made from these settings.
  bool fits(const SonarSettings& settings) const;
};

/// Multiplies each line of the image by its loss. @param loss per line
void apply_loss(const std::vector<float>& loss, EchoImage& image);

}  // namespace sonard::render
