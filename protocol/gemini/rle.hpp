// SPDX-License-Identifier: Apache-2.0
// Run-length coding of zero beams in a range line of 8-bit samples (docs/protocols/gemini.md 6.8).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sonard::gemini {

/// Beams below it become zero under a threshold of 3..255; smaller thresholds act as 3, because 0 and 1 have
/// a meaning of their own in the coded form.
std::uint8_t least_literal(std::uint8_t threshold);

/// Appends the coded form of one range line to `out` and pads it with 0x00 to a multiple of 4 bytes, counted
/// from where this call began. Beams below
/// least_literal(threshold) become zero (PingConfig::rle_threshold_applied). A single zero is 0x01; runs
/// of 2..255 are 0x00 followed by the count, longer runs are split; everything else is literal. The coded
/// form never exceeds the line padded to 4.
void rle_encode(std::span<const std::uint8_t> beams, std::uint8_t threshold, std::vector<std::uint8_t>& out);

/// Decodes into `beams`; beams that `data` does not reach become zero. Stops at the end of `data` or when
/// `beams` is full, whichever comes first, so padding is harmless; a run longer than what is left is cut, and
/// a 0x00 that ends the data without its count is no beam. Returns how many beams came out of `data`.
std::size_t rle_decode(std::span<const std::uint8_t> data, std::span<std::uint8_t> beams);

}  // namespace sonard::gemini
