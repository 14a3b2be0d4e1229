// SPDX-License-Identifier: Apache-2.0
// Settings of mode `paper`.
#pragma once

namespace sonard::render {

/// Mode `paper`, with an interpretation for each point that the paper leaves open (docs/physics.md 1.2).
struct PaperModel {
  double sigmoid_slope = 18.0;        ///< A1
  double sigmoid_centre = 2.0 / 3.0;  ///< A1
  bool two_sided = true;              ///< A3; false: back faces are invisible
  bool legacy_bin_index = false;      ///< A4; floor(r / R_max (N - 1)) instead of floor(r / R_max N)
  bool legacy_columns = false;        ///< A7; assigns a whole column to the beam of its centre
  bool elevation_mask = true;         ///< false: the whole planar view counts, as in the paper
  bool footprint = true;              ///< false: a sample is a point in range
  double attenuation_per_m = 0.0;     ///< A10; a of exp(-2 a r), applied before the sigmoid
  double gain = 0.5;                  ///< A9; 0.5 is neutral, applied after speckle with a clamp at 1
  enum class Speckle { off, gaussian, folded_gaussian } speckle = Speckle::gaussian;  ///< A8
  double speckle_mean = 0.40;
  double speckle_sd = 0.15;
  double speckle_floor = 0.0;

  bool operator==(const PaperModel&) const = default;

  /// The authors' later public releases: folded N(0.95, 0.30) with floor 0.03, and attenuation. The
  /// attenuation here is cool sea water at 720 kHz (0.2085 dB/m as a factor of amplitude).
  static PaperModel release_2018() {
    PaperModel model;
    model.attenuation_per_m = 0.024;
    model.speckle = Speckle::folded_gaussian;
    model.speckle_mean = 0.95;
    model.speckle_sd = 0.30;
    model.speckle_floor = 0.03;
    return model;
  }
};

}  // namespace sonard::render
