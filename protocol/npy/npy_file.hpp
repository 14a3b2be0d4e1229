// SPDX-License-Identifier: Apache-2.0
// Arrays as NumPy keeps them: format 1.0 of numpy.lib.format. No state; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/result.hpp"

namespace sonard::npy {

/// A table of unsigned samples, row after row: `u8`, or `u16` where that is not empty.
struct Table {
  int rows = 0;
  int columns = 0;
  std::vector<std::uint8_t> u8;
  std::vector<std::uint16_t> u16;

  bool operator==(const Table&) const = default;
};

/// What stands before the samples: magic, version, length of the header, and a Python literal padded so that
/// the samples begin at a multiple of 64.
/// @param dtype "|u1" or "<u2"
/// @param rows, columns of the samples that follow, row by row
std::string header(std::string_view dtype, int rows, int columns);

/// The whole file. Requires rows * columns samples.
std::string encode(const Table& table);

/// Parses any file of one sample or more in C order.
/// @return what is wrong with another file: "is no NumPy file of format 1.0"
Result<Table, std::string> parse(std::string_view file);

}  // namespace sonard::npy
