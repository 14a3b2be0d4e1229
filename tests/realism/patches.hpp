// SPDX-License-Identifier: Apache-2.0
// How spiky homogeneous parts of an image are. The estimator picks the parts itself, so that it can be
// applied to recordings and to rendered images alike.
#pragma once

#include <vector>

namespace sonard::realism {

/// Samples of a multibeam head in proportion to the amplitude; [line * beams + beam].
struct AmplitudeImage {
  int lines = 0;
  int beams = 0;
  double full_scale = 1;  ///< amplitude of the highest code
  std::vector<double> amplitude;
};

struct Patch {
  double mean = 0;       ///< amplitude
  double variation = 0;  ///< standard deviation over mean of the amplitude: 0.523 of Rayleigh echoes
  double index = 0;  ///< variance over squared mean of the intensity: 1 of Rayleigh echoes, 1 + 2 / nu of K
};

inline constexpr int patch_beams = 40;
inline constexpr int patch_lines = 16;

/// Patches side by side, of 40 beams by 16 lines, that are homogeneous: the mean of each quadrant differs
/// from that of the patch by less than 0.6 standard deviations, and at most 2 % of the samples are 0 or full
/// scale. A plane is taken off before the spread of amplitude and intensity is measured. Darkest first.
std::vector<Patch> homogeneous_patches(const AmplitudeImage& image);

enum class Third { dark, middle, bright };

/// Medians over a third of the patches.
/// @param patches from homogeneous_patches(); with fewer than three all is NaN
Patch median_of(const std::vector<Patch>& patches, Third third);

}  // namespace sonard::realism
