// SPDX-License-Identifier: Apache-2.0
// The slices with which a ping begins, before any is divided.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/engines/slices/fan.hpp"
#include "renderer/engines/slices/slice_accuracy.hpp"
#include "renderer/engines/slices/slice_math.hpp"

namespace sonard::render {

struct FirstSlice {
  int beam;
  double azimuth_rad;  ///< of its middle
  double width_rad;
};

/// Divides every beam evenly; wide and oblique beams get more slices. From port to starboard.
std::vector<FirstSlice> first_slices(const Fan& fan, double line_m, const SliceAccuracy& accuracy);

/// The elevation pattern at the probes, divided by its mean: errors in a side lobe count little. In whole
/// numbers of 1 / probe_weight_unit, because sums of floats do not vectorise.
using ProbeWeights = std::array<std::int32_t, slices::side_probes>;
using slices::probe_weight_unit;
ProbeWeights probe_weights(const Aperture& aperture, float tan_limit);

}  // namespace sonard::render
