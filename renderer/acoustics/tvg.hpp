// SPDX-License-Identifier: Apache-2.0
// Time-varying gain, with which the receiver compensates spreading and absorption (docs/physics.md 2.9).
#pragma once

#include <vector>

#include "renderer/physical_model.hpp"
#include "renderer/range_bins.hpp"

namespace sonard::render {

/// Time-varying gain of mode `physical` at a range, in dB, up to its ceiling. @param range_m > 0
double tvg_db(const TvgSettings& tvg, double range_m);

/// Time-varying gain and gain setting of mode `physical` per range bin, as amplitude.
std::vector<float> tvg_amplitudes(const PhysicalModel& model, const RangeBins& range);

}  // namespace sonard::render
