// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/bins.hpp"

#include <algorithm>

namespace sonard::micron {

std::uint8_t to_four_bit(std::uint8_t amplitude, std::uint8_t ad_low, std::uint8_t ad_span) {
  const int above = std::max(0, amplitude - ad_low);
  return static_cast<std::uint8_t>(std::min(15, above * 16 / std::max<int>(1, ad_span)));
}

std::vector<std::uint8_t> pack_nibbles(std::span<const std::uint8_t> values, NibbleOrder order) {
  std::vector<std::uint8_t> bytes((values.size() + 1) / 2);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool high = (i % 2 == 0) == (order == NibbleOrder::high_first);
    bytes[i / 2] = static_cast<std::uint8_t>(bytes[i / 2] | values[i] << (high ? 4 : 0));
  }
  return bytes;
}

std::vector<std::uint8_t> unpack_nibbles(std::span<const std::uint8_t> bytes, NibbleOrder order) {
  std::vector<std::uint8_t> values;
  values.reserve(2 * bytes.size());
  for (const std::uint8_t byte : bytes) {
    const auto high = static_cast<std::uint8_t>(byte >> 4);
    const auto low = static_cast<std::uint8_t>(byte & 0xF);
    values.push_back(order == NibbleOrder::high_first ? high : low);
    values.push_back(order == NibbleOrder::high_first ? low : high);
  }
  return values;
}

}  // namespace sonard::micron
