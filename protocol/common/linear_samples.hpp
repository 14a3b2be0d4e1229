// SPDX-License-Identifier: Apache-2.0
// Converts 8-bit samples to amplitudes, for pictures.
#pragma once

#include <cstdint>
#include <span>

namespace sonard {

/// Makes samples proportional to the amplitude that were proportional to its power `amplitude_exponent` > 0
/// (RecordedSettings::amplitude_exponent). Full scale does not change.
void make_linear(std::span<std::uint8_t> samples, double amplitude_exponent);

}  // namespace sonard
