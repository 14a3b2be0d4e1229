// SPDX-License-Identifier: Apache-2.0
#include "common/text/lower_case.hpp"

#include <algorithm>
#include <cctype>

namespace sonard {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

}  // namespace sonard
