// SPDX-License-Identifier: Apache-2.0
// How closely slices follow the world, for each preset.
#pragma once

#include "renderer/model.hpp"
#include "renderer/sampling.hpp"

namespace sonard::render {

/// Accuracy of slices; the defaults keep errors below 1 %.
struct SliceAccuracy {
  int slices_per_beam = 1;  ///< at the start; wide and oblique beams get more
  /// No slice is narrower than a beam divided by this, unless it lies between upright edges; 1: the first
  /// slices are not divided.
  int most_divisions = 75;
  /// Replaces most_divisions for slices whose sides disagree over most of the beam's elevations with an echo,
  /// as at the limb of a ball in open water: there a narrow slice may hold the whole echo.
  int most_divisions_of_lone_echoes = 125;
  /// Slices are divided until their range mismatch, (share of elevations at which neighbours disagree) *
  /// (width / beam width), is at most this share of the elevations at which the beam receives an echo. Both
  /// shares are weighted by the elevation pattern. The sum over the beam is computed as for independent
  /// errors.
  float disagreement = 2e-3F;
  /// Slices are also divided while the elevations at which they disagree may move the centroid of the beam's
  /// echo by more than this, because a few elevations may hold much of an echo.
  float shift_lines = 0.2F;
  /// A surface that spreads over n range lines may have a sagitta of this times n lines within a slice. The
  /// sagitta displaces the first and the last line, which counts more the fewer lines there are.
  float sagitta_lines = 6e-4F;
  float linearity = 0.03F;     ///< see SlicePatcher::Request
  float change = 0.002F;       ///< RMS relative change of a wall's echo allowed within a first slice
  float mapped_lines = 2.5F;   ///< see SlicePatcher::Request
  float facet_slopes = 0.17F;  ///< see SlicePatcher::Request
  float facet_lines = 0.006F;  ///< see SlicePatcher::Request
  bool within_facets = false;  ///< see Sampling
};

/// The accuracy of a preset (docs/accuracy.md). @param sampling its preset is not `grid`
SliceAccuracy slice_accuracy(const Sampling& sampling, Model model);

}  // namespace sonard::render
