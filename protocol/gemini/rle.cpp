// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/rle.hpp"

#include <algorithm>

namespace sonard::gemini {
namespace {

constexpr std::uint8_t run_marker = 0x00;  // a count follows
constexpr std::uint8_t single_zero = 0x01;
constexpr std::size_t longest_run = 255;
constexpr std::uint8_t smallest_threshold = 3;

void append_zeros(std::size_t run, std::vector<std::uint8_t>& out) {
  while (run > 1) {
    const std::size_t part = std::min(run, longest_run);
    out.push_back(run_marker);
    out.push_back(static_cast<std::uint8_t>(part));
    run -= part;
  }
  if (run == 1) {
    out.push_back(single_zero);
  }
}

}  // namespace

std::uint8_t least_literal(std::uint8_t threshold) {
  return std::max(threshold, smallest_threshold);
}

void rle_encode(std::span<const std::uint8_t> beams, std::uint8_t threshold, std::vector<std::uint8_t>& out) {
  const std::size_t start = out.size();
  const std::uint8_t least = least_literal(threshold);
  std::size_t run = 0;
  for (const std::uint8_t beam : beams) {
    if (beam < least) {
      ++run;
      continue;
    }
    append_zeros(run, out);
    run = 0;
    out.push_back(beam);
  }
  append_zeros(run, out);
  // Decoders distinguish padding from data by the number of beams: they stop before the padding.
  out.resize(start + (out.size() - start + 3) / 4 * 4);
}

std::size_t rle_decode(std::span<const std::uint8_t> data, std::span<std::uint8_t> beams) {
  std::ranges::fill(beams, std::uint8_t{0});
  std::size_t beam = 0;
  for (std::size_t i = 0; i < data.size() && beam < beams.size(); ++i) {
    if (data[i] == run_marker) {
      if (++i == data.size()) {
        break;
      }
      beam += std::min<std::size_t>(data[i], beams.size() - beam);
    } else if (data[i] == single_zero) {
      ++beam;
    } else {
      beams[beam++] = data[i];
    }
  }
  return beam;
}

}  // namespace sonard::gemini
