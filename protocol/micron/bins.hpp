// SPDX-License-Identifier: Apache-2.0
// Amplitudes of one line as they travel: 8 bit, or two to a byte (docs/protocols/micron.md 6.3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sonard::micron {

/// Which half of a byte holds the nearer of its two bins. Real drivers disagree.
enum class NibbleOrder : std::uint8_t { high_first, low_first };

/// 8-bit amplitude in the window from `ad_low`, `ad_span` wide, as 0..15; below it 0, above it 15.
std::uint8_t to_four_bit(std::uint8_t amplitude, std::uint8_t ad_low, std::uint8_t ad_span);

/// Values 0..15, two to a byte; an odd number is filled up with 0.
std::vector<std::uint8_t> pack_nibbles(std::span<const std::uint8_t> values, NibbleOrder order);
/// All of them, so one too many where an odd number was packed.
std::vector<std::uint8_t> unpack_nibbles(std::span<const std::uint8_t> bytes, NibbleOrder order);

}  // namespace sonard::micron
