// SPDX-License-Identifier: Apache-2.0
// Small records and logs for the tests of logs, and values read out of bytes without the code under test.
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

/// The value of that type at `offset`; zero, and a failed test, where there is none.
template <class Value>
Value value_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  Value value{};
  EXPECT_LE(offset + sizeof(Value), bytes.size());
  if (offset + sizeof(Value) <= bytes.size()) {
    std::memcpy(&value, bytes.data() + offset, sizeof(Value));
  }
  return value;
}

/// Overwrites what is at `offset`.
template <class Value>
void patch(Bytes& bytes, std::size_t offset, Value value) {
  ASSERT_LE(offset + sizeof(Value), bytes.size());
  std::memcpy(bytes.data() + offset, &value, sizeof(Value));
}

/// "DE de" as bytes.
Bytes from_hex(const std::string& text);

/// 2 lines by 3 beams, too small for zlib to shrink, and a value of its own in every field.
ImageRecord small_image();
/// 50 lines by 64 beams of the pattern (7 * number + 3 * line + 5 * beam) mod 256, which shrinks well.
ImageRecord patterned_image(int number);
/// A value of its own in every field.
StatusRecord small_status();

Bytes joined(const std::vector<Bytes>& parts);
/// Two images, a status and one more image, closed.
Bytes small_dat();
/// The same as a .glf.
Bytes packed(const Bytes& dat, const std::string& config_xml = "<genesisLog/>\n");

}  // namespace sonard::glf::testing
