// SPDX-License-Identifier: Apache-2.0
// Measures how spiky homogeneous parts of an image are. The estimator selects the parts itself, so that it
// treats recordings and rendered images alike.
#pragma once

#include <vector>

namespace sonard::realism {

/// Samples of a multibeam head, proportional to the amplitude; [line * beams + beam].
struct AmplitudeImage {
  int lines = 0;
  int beams = 0;
  double full_scale = 1;  ///< amplitude of the highest code
  std::vector<double> amplitude;
};

struct Patch {
  double mean = 0;       ///< amplitude
  double variation = 0;  ///< standard deviation over mean of the amplitude; 0.523 for Rayleigh echoes
  double index = 0;  ///< variance over squared mean of the intensity; 1 for Rayleigh echoes, 1 + 2 / nu for K
};

inline constexpr int patch_beams = 40;
inline constexpr int patch_lines = 16;

/// Finds adjoining patches of 40 beams by 16 lines that are homogeneous: the mean of each quadrant differs
/// from the patch's mean by less than 0.6 standard deviations, and at most 2 % of the samples are 0 or full
/// scale. The spread of amplitude and intensity is measured after subtracting a plane. Darkest first.
std::vector<Patch> homogeneous_patches(const AmplitudeImage& image);

enum class Third { dark, middle, bright };

/// The medians over a third of the patches.
/// @param patches from homogeneous_patches(); with fewer than three patches, the result is NaN
Patch median_of(const std::vector<Patch>& patches, Third third);

}  // namespace sonard::realism
