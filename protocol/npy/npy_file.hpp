// SPDX-License-Identifier: Apache-2.0
// NumPy array files: format 1.0 of numpy.lib.format. No state; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/result.hpp"

namespace sonard::npy {

/// A table of samples, row after row, in the one list that is not empty.
struct Table {
  int rows = 0;
  int columns = 0;
  std::vector<std::uint8_t> u8;
  std::vector<std::uint16_t> u16;
  std::vector<float> f32{};

  bool operator==(const Table&) const = default;
};

/// The bytes before the samples: magic, version, length of the header, and a Python literal padded so that
/// the samples begin at a multiple of 64.
/// @param dtype "|u1", "<u2" or "<f4"
/// @param rows, columns shape of the samples that follow, row by row
std::string header(std::string_view dtype, int rows, int columns);

/// Encodes the whole file. Requires rows * columns samples.
std::string encode(const Table& table);

/// Parses a file with a table of at least one sample in C order.
/// @return the table, or the error of the file: "is not a NumPy file of format 1.0"
Result<Table, std::string> parse(std::string_view file);

}  // namespace sonard::npy
