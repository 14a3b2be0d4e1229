// SPDX-License-Identifier: Apache-2.0
// Run-length coding of zero beams in a range line of 8-bit samples (protocol/gemini/README.md 6.8).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sonard::gemini {

/// The smallest sample that is not set to zero for a threshold. Thresholds below 3 act as 3, because 0 and 1
/// have special meanings in the coded form.
std::uint8_t least_literal(std::uint8_t threshold);

/// Appends the coded form of one range line to `out`, padded with 0x00 to a multiple of 4 bytes from its
/// start. Beams below least_literal(threshold) become zero (PingConfig::rle_threshold_applied). A single zero
/// is 0x01; runs of 2..255 are 0x00 followed by the count, longer runs are split; all other values are
/// literal. The coded form is never longer than the line padded to 4.
void rle_encode(std::span<const std::uint8_t> beams, std::uint8_t threshold, std::vector<std::uint8_t>& out);

/// Decodes into `beams` and returns the number of decoded beams; the remaining beams become zero. Stops at
/// the end of `data` or when `beams` is full, so padding has no effect. A run longer than the remaining beams
/// is cut. A final 0x00 without a count is ignored.
std::size_t rle_decode(std::span<const std::uint8_t> data, std::span<std::uint8_t> beams);

}  // namespace sonard::gemini
