// SPDX-License-Identifier: Apache-2.0
// Wire format of the amplitudes of a line: 8 bits, or 4 bits with two bins per byte
// (protocol/micron/README.md 6.3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sonard::micron {

/// Which half of a byte holds the nearer of its two bins. Drivers differ.
enum class NibbleOrder : std::uint8_t { high_first, low_first };

/// Maps an 8-bit amplitude in the window [ad_low, ad_low + ad_span] to 0..15; below it 0, above it 15.
std::uint8_t to_four_bit(std::uint8_t amplitude, std::uint8_t ad_low, std::uint8_t ad_span);

/// Packs values 0..15, two per byte; an odd number is padded with 0.
std::vector<std::uint8_t> pack_nibbles(std::span<const std::uint8_t> values, NibbleOrder order);
/// Unpacks both values of all bytes, so one too many if an odd number was packed.
std::vector<std::uint8_t> unpack_nibbles(std::span<const std::uint8_t> bytes, NibbleOrder order);

}  // namespace sonard::micron
