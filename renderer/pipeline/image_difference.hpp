// SPDX-License-Identifier: Apache-2.0
// How far two images are apart.
#pragma once

#include "renderer/ping.hpp"

namespace sonard::render {

/// RMS of (bin / that of the truth - 1) over the bins that in the truth are above 1e-2 of the largest of
/// their beam. 0 where there is none of these, infinite where a bin of the image is not finite.
/// @param truth of the same size.
/// @param kept_share of these bins are looked at: the worst ones are left out.
double bin_rms(const EchoImage& image, const EchoImage& truth, double kept_share = 1.0);

}  // namespace sonard::render
