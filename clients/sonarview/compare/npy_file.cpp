// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/compare/npy_file.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstddef>
#include <fstream>
#include <regex>
#include <stdexcept>
#include <string>

namespace sonard::client {

static_assert(std::endian::native == std::endian::little, "samples of 16 bits are taken as they are");

namespace {

constexpr long most_samples = 1L << 28;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
  throw std::runtime_error(fmt::format("{}: {}", file.string(), why));
}

/// Magic, version 1.0, length of the header in two bytes, and that many characters of a Python literal.
std::string read_header(std::ifstream& in, const std::filesystem::path& file) {
  std::array<char, 10> preamble{};
  in.read(preamble.data(), preamble.size());
  if (!in || std::string(preamble.data(), 8) != std::string("\x93NUMPY\x01\x00", 8)) {
    refuse(file, "is no NumPy file of format 1.0");
  }
  std::string header(static_cast<unsigned char>(preamble[8]) + 256U * static_cast<unsigned char>(preamble[9]),
                     '\0');
  in.read(header.data(), static_cast<std::streamsize>(header.size()));
  if (!in) {
    refuse(file, "is cut short");
  }
  return header;
}

int size_in(const std::string& text, const std::filesystem::path& file) {
  if (text.size() > 9 || std::stol(text) == 0) {
    refuse(file, "has no samples, or too many");
  }
  return std::stoi(text);
}

}  // namespace

cv::Mat read_npy(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string header = read_header(in, file);
  static const std::regex table(
      R"(\{'descr': '(\|u1|<u2)', 'fortran_order': False, 'shape': \((\d+), (\d+)\), \}\s*)");
  std::smatch parts;
  if (!std::regex_match(header, parts, table)) {
    refuse(file, "is no table of 8 or 16 bit samples");
  }
  const int rows = size_in(parts[2], file);
  const int columns = size_in(parts[3], file);
  if (static_cast<long>(rows) * columns > most_samples) {
    refuse(file, "has too many samples");
  }
  cv::Mat samples(rows, columns, parts[1] == "|u1" ? CV_8UC1 : CV_16UC1);
  in.read(samples.ptr<char>(), static_cast<std::streamsize>(samples.total() * samples.elemSize()));
  if (!in || in.peek() != std::ifstream::traits_type::eof()) {
    refuse(file, "does not hold as many samples as it says");
  }
  return samples;
}

}  // namespace sonard::client
