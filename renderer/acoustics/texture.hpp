// SPDX-License-Identifier: Apache-2.0
// Texture: how the number of scatterers varies from cell to cell (docs/physics.md 2.8).
#pragma once

#include "renderer/aligned_vector.hpp"
#include "renderer/physical_model.hpp"

namespace sonard::render {

/// sqrt(t) with t ~ Gamma(nu, 1/nu), as a rising function of a standard normal number. It turns a field of
/// normal numbers into texture with the same correlation. Speckle times texture has K distributed amplitudes
/// and the scintillation index 1 + 2 / nu.
class TextureRoot {
 public:
  /// @param nu > 0; clamped to [1/16, 1024]
  void set(double nu);

  /// out[i] = intensity[i] * t(sqrt 2 * gaussian[i]). @param gaussian of variance 1/2: one part of CN(0, 1).
  void apply(const float* intensity, const float* gaussian, int count, float* out) const;

 private:
  AlignedVector<float> root_;  ///< at equidistant normal numbers
};

/// Effective number of scatterers in a cell at a range; cells of a fan grow in proportion to range.
double scatterers_at(const SpeckleSettings& speckle, double range_m);

/// Above this number of scatterers in a cell, texture has no visible effect (SkipRule::many_scatterers).
inline constexpr double texture_ends_at_nu = 20.0;

}  // namespace sonard::render
