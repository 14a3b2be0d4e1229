// SPDX-License-Identifier: Apache-2.0
// How closely slices follow the world, for each preset.
#pragma once

#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// How closely slices follow the world; the defaults keep within 1 %.
struct SliceAccuracy {
  int slices_per_beam = 1;  ///< to begin with; wide and oblique beams get more
  /// No slice is narrower than a beam divided by this, unless it lies between upright edges; 1: the first
  /// slices stay.
  int most_divisions = 75;
  /// The same of slices at whose sides most of what the beam receives is in disagreement, as at the limb of a
  /// ball in open water: there a narrow slice may be all of an echo.
  int most_divisions_of_lone_echoes = 125;
  /// A first slice at whose sides neighbours disagree is divided in five, even if three would do: with coarse
  /// targets the ends of shadows then still reach their lines.
  bool first_in_five = false;
  /// Slices are divided until their range mismatch is at most this share of the elevations at which the beam
  /// receives anything: (share of elevations at which neighbours disagree) * (width / beam width), summed
  /// over the beam as independent errors are.
  float disagreement = 2e-3F;
  /// Slices are divided too while the elevations at which they disagree might move the centroid of the beam's
  /// echo by more than this: a few elevations may hold much of an echo.
  float shift_lines = 0.2F;
  /// A surface that spreads over n range lines may have a sagitta of this times n lines within a slice: it
  /// displaces the first and last of them, and the fewer there are the more that matters.
  float sagitta_lines = 6e-4F;
  float linearity = 0.03F;     ///< see SlicePatcher::Request
  float change = 0.005F;       ///< share by which a wall's echo may change within a first slice, RMS
  float mapped_lines = 2.5F;   ///< see SlicePatcher::Request
  float facet_slopes = 0.17F;  ///< see SlicePatcher::Request
  float facet_lines = 0.006F;  ///< see SlicePatcher::Request
};

/// The accuracy that keeps the promise of a preset (docs/accuracy.md). @param preset not `grid`
SliceAccuracy slice_accuracy(Sampling::Preset preset, Model model);

}  // namespace sonard::render
