// SPDX-License-Identifier: Apache-2.0
#include "tests/support/hex_fixture.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace sonard::testing {
namespace {

std::filesystem::path path_of(const std::string& folder) {
  return std::filesystem::path{SONARD_SOURCE_DIR} / "tests/data" / folder;
}

}  // namespace

Bytes load_hex_fixture(const std::string& folder, const std::string& name) {
  std::ifstream file{path_of(folder) / (name + ".hex")};
  Bytes bytes;
  for (std::string word; file >> word;) {
    std::uint8_t byte = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), byte, 16);
    if (error != std::errc{} || end != word.data() + word.size() || word.size() != 2) {
      throw std::runtime_error{"fixture " + name + ": not a byte: " + word};
    }
    bytes.push_back(byte);
  }
  if (bytes.empty()) {
    throw std::runtime_error{"no fixture " + name};
  }
  return bytes;
}

std::vector<std::string> hex_fixture_names(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator{path_of(folder)}) {
    if (entry.path().extension() == ".hex") {
      names.push_back(entry.path().stem().string());
    }
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace sonard::testing
