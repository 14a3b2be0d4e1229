// SPDX-License-Identifier: Apache-2.0
#include "protocol/npy/npy_file.hpp"

#include <bit>
#include <cassert>
#include <cstring>
#include <regex>

namespace sonard::npy {

static_assert(std::endian::native == std::endian::little, "samples are taken as they are");

namespace {

constexpr std::string_view magic("\x93NUMPY\x01\x00", 8);
constexpr std::size_t preamble_bytes = 10;  // magic, and the length of the header
constexpr std::string_view eight_bit = "|u1";
constexpr std::string_view sixteen_bit_le = "<u2";
constexpr std::string_view float_le = "<f4";

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

std::string header(std::string_view dtype, int rows, int columns) {
  std::string dictionary = "{'descr': '" + std::string(dtype) + "', 'fortran_order': False, 'shape': (" +
                           std::to_string(rows) + ", " + std::to_string(columns) + "), }";
  constexpr std::size_t alignment = 64;
  const std::size_t unpadded = preamble_bytes + dictionary.size() + 1;
  dictionary.append((alignment - unpadded % alignment) % alignment, ' ');
  dictionary.push_back('\n');
  std::string file(magic);
  file.push_back(static_cast<char>(dictionary.size() & 0xFF));
  file.push_back(static_cast<char>(dictionary.size() >> 8));
  return file + dictionary;
}

std::string encode(const Table& table) {
  assert(table.u8.size() + table.u16.size() + table.f32.size() ==
         static_cast<std::size_t>(table.rows) * static_cast<std::size_t>(table.columns));
  const std::string_view dtype = !table.f32.empty()  ? float_le
                                 : table.u16.empty() ? eight_bit
                                                     : sixteen_bit_le;
  std::string file = header(dtype, table.rows, table.columns);
  for (const std::string_view samples : {as_text(table.u8), as_text(table.u16), as_text(table.f32)}) {
    file += samples;
  }
  return file;
}

Result<Table, std::string> parse(std::string_view file) {
  if (file.size() < preamble_bytes || !file.starts_with(magic)) {
    return std::string("is not a NumPy file of format 1.0");
  }
  const std::size_t header_bytes =
      static_cast<unsigned char>(file[8]) + 256U * static_cast<unsigned char>(file[9]);
  const std::string text(file.substr(preamble_bytes, header_bytes));
  static const std::regex form(
      R"(\{'descr': '(\|u1|<u2|<f4)', 'fortran_order': False, 'shape': \((\d+), (\d+)\), \}\s*)");
  std::smatch parts;
  if (text.size() < header_bytes || !std::regex_match(text, parts, form)) {
    return std::string("is not a table of 8-bit, 16-bit or float samples");
  }
  if (parts.length(2) > 9 || parts.length(3) > 9) {
    return std::string("has too many samples");
  }
  Table table{std::stoi(parts[2]), std::stoi(parts[3]), {}, {}, {}};
  const auto count = static_cast<std::size_t>(table.rows) * static_cast<std::size_t>(table.columns);
  if (count == 0) {
    return std::string("has no samples");
  }
  file.remove_prefix(preamble_bytes + header_bytes);
  const std::string dtype = parts.str(1);
  if (!(dtype == eight_bit        ? fill(table.u8, file, count)
        : dtype == sixteen_bit_le ? fill(table.u16, file, count)
                                  : fill(table.f32, file, count))) {
    return std::string("does not have the number of samples in its header");
  }
  return table;
}

}  // namespace sonard::npy
