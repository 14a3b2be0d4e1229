// SPDX-License-Identifier: Apache-2.0
// Expected lines in data files, where "..." is any text.
#pragma once

#include <string_view>

namespace sonard::test {

/// True if `line` is `pattern`, with any text for each "..." in the pattern.
inline bool matches(std::string_view line, std::string_view pattern) {
  const std::size_t gap = pattern.find("...");
  if (gap == std::string_view::npos) {
    return line == pattern;
  }
  if (!line.starts_with(pattern.substr(0, gap))) {
    return false;
  }
  for (std::size_t end = gap; end <= line.size(); ++end) {
    if (matches(line.substr(end), pattern.substr(gap + 3))) {
      return true;
    }
  }
  return false;
}

}  // namespace sonard::test
