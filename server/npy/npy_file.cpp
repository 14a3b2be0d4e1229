// SPDX-License-Identifier: Apache-2.0
#include "server/npy/npy_file.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <utility>

#include <fmt/format.h>

namespace sonard::server {

static_assert(std::endian::native == std::endian::little, "samples of 16 bits are written as they are");

namespace {

constexpr std::string_view eight_bit = "|u1";
constexpr std::string_view sixteen_bit_le = "<u2";

template <class Sample>
std::string_view as_text(const std::vector<Sample>& samples) {
  return {reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof(Sample)};
}

template <class Sample>
bool fill(std::vector<Sample>& samples, std::string_view bytes, std::size_t count) {
  if (bytes.size() != count * sizeof(Sample)) {
    return false;
  }
  samples.resize(count);
  std::memcpy(samples.data(), bytes.data(), bytes.size());
  return true;
}

}  // namespace

std::string npy_header(std::string_view dtype, int rows, int columns) {
  std::string dictionary =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}", dtype, rows, columns);
  constexpr std::size_t preamble = 10;
  constexpr std::size_t alignment = 64;
  const std::size_t unpadded = preamble + dictionary.size() + 1;
  dictionary.append((alignment - unpadded % alignment) % alignment, ' ');
  dictionary.push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  header.push_back(static_cast<char>(dictionary.size() & 0xFF));
  header.push_back(static_cast<char>(dictionary.size() >> 8));
  return header + dictionary;
}

std::string npy_bytes(const NpyTable& table) {
  assert(std::max(table.u8.size(), table.u16.size()) ==
         static_cast<std::size_t>(table.rows) * static_cast<std::size_t>(table.columns));
  std::string file = npy_header(table.u16.empty() ? eight_bit : sixteen_bit_le, table.rows, table.columns);
  file += table.u16.empty() ? as_text(table.u8) : as_text(table.u16);
  return file;
}

std::optional<NpyTable> parse_npy(std::string_view file, int rows, int columns, bool sixteen_bit) {
  const std::string header = npy_header(sixteen_bit ? sixteen_bit_le : eight_bit, rows, columns);
  if (!file.starts_with(header)) {
    return std::nullopt;
  }
  file.remove_prefix(header.size());
  const auto count = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  NpyTable table{rows, columns, {}, {}};
  const bool whole = sixteen_bit ? fill(table.u16, file, count) : fill(table.u8, file, count);
  return whole ? std::optional(std::move(table)) : std::nullopt;
}

}  // namespace sonard::server
