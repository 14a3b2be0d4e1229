// SPDX-License-Identifier: Apache-2.0
// The difference between two images.
#pragma once

#include "renderer/ping.hpp"

namespace sonard::render {

/// RMS of (bin / true bin - 1) over the bins that are above 1e-2 of their beam's maximum in `truth`. 0 if
/// there are no such bins; infinite if a bin of the image is not finite.
/// @param truth must have the same size.
/// @param kept_share share of these bins that counts: the worst ones are left out.
double bin_rms(const EchoImage& image, const EchoImage& truth, double kept_share = 1.0);

}  // namespace sonard::render
