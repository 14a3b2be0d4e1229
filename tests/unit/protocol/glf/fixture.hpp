// SPDX-License-Identifier: Apache-2.0
// Small records and logs for the tests of logs, and functions that read values without the code under test.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "protocol/glf/log_view.hpp"
#include "protocol/glf/packer.hpp"

namespace sonard::glf::testing {

using Bytes = std::vector<std::uint8_t>;

static_assert(std::endian::native == std::endian::little, "value_at() reads as the file has it");

/// The value of type Value at `offset`. Returns zero and fails the test if the bytes end before it.
template <class Value>
Value value_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  Value value{};
  EXPECT_LE(offset + sizeof(Value), bytes.size());
  if (offset + sizeof(Value) <= bytes.size()) {
    std::memcpy(&value, bytes.data() + offset, sizeof(Value));
  }
  return value;
}

/// Overwrites the bytes at `offset` with the value.
template <class Value>
void patch(Bytes& bytes, std::size_t offset, Value value) {
  ASSERT_LE(offset + sizeof(Value), bytes.size());
  std::memcpy(bytes.data() + offset, &value, sizeof(Value));
}

/// "DE de" as bytes.
Bytes from_hex(const std::string& text);

/// 2 lines by 3 beams, too small for zlib to shrink. Every field has a different value.
ImageRecord small_image();
/// 50 lines by 64 beams of the pattern (7 * number + 3 * line + 5 * beam) mod 256, which shrinks well.
ImageRecord patterned_image(int number);
/// A status in which every field has a different value.
StatusRecord small_status();

Bytes joined(const std::vector<Bytes>& parts);
/// A closed .dat with two images, a status and one more image.
Bytes small_dat();
/// The .dat as a .glf archive.
Bytes packed(const Bytes& dat, const std::string& config_xml = "<genesisLog/>\n");

}  // namespace sonard::glf::testing
