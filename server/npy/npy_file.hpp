// SPDX-License-Identifier: Apache-2.0
// Arrays as NumPy keeps them: format 1.0 of numpy.lib.format. No state; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonard::server {

/// A table of unsigned samples, row after row: `u8`, or `u16` where that is not empty.
struct NpyTable {
  int rows = 0;
  int columns = 0;
  std::vector<std::uint8_t> u8;
  std::vector<std::uint16_t> u16;

  bool operator==(const NpyTable&) const = default;
};

/// What stands before the samples: magic, version, length of the header, and a Python literal padded so that
/// the samples begin at a multiple of 64.
/// @param dtype "|u1" or "<u2"
std::string npy_header(std::string_view dtype, int rows, int columns);

/// The whole file. Requires rows * columns samples.
std::string npy_bytes(const NpyTable& table);

/// Parses a file with exactly that header and as many samples as it says.
/// @return nullopt for any other file
std::optional<NpyTable> parse_npy(std::string_view file, int rows, int columns, bool sixteen_bit);

}  // namespace sonard::server
