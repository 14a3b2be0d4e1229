// SPDX-License-Identifier: Apache-2.0
#include "protocol/mavlink/checksum.hpp"

#include <array>

namespace sonard::mavlink {
namespace {

// Polynomial x^16 + x^12 + x^5 + 1, least significant bit first.
constexpr std::uint16_t reversed_polynomial = 0x8408;
constexpr std::uint16_t start = 0xFFFF;

constexpr std::array<std::uint16_t, 256> make_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::uint16_t byte = 0; byte < 256; ++byte) {
    std::uint16_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      const bool odd = (remainder & 1U) != 0;
      remainder = static_cast<std::uint16_t>((remainder >> 1U) ^ (odd ? reversed_polynomial : 0U));
    }
    table[byte] = remainder;
  }
  return table;
}

constexpr std::array<std::uint16_t, 256> table = make_table();

std::uint16_t add(std::uint16_t remainder, std::uint8_t byte) {
  return static_cast<std::uint16_t>((remainder >> 8U) ^ table[(remainder ^ byte) & 0xFFU]);
}

}  // namespace

std::uint16_t checksum(std::span<const std::uint8_t> bytes, std::uint8_t seed) {
  std::uint16_t remainder = start;
  for (const std::uint8_t byte : bytes) {
    remainder = add(remainder, byte);
  }
  return add(remainder, seed);
}

}  // namespace sonard::mavlink
