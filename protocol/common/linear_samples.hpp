// SPDX-License-Identifier: Apache-2.0
// Samples of 8 bits as amplitudes, for pictures.
#pragma once

#include <cstdint>
#include <span>

namespace sonard {

/// Puts samples in proportion to the amplitude, that were in proportion to its power
/// (RecordedSettings::amplitude_exponent, > 0); full scale stays what it is.
void make_linear(std::span<std::uint8_t> samples, double amplitude_exponent);

}  // namespace sonard
