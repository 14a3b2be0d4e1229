// SPDX-License-Identifier: Apache-2.0
// A number with its noun.
#pragma once

#include <concepts>
#include <string>
#include <string_view>

namespace sonard {

/// "1 frame", "2 frames". @param noun in the singular; its plural ends with s
template <std::integral Count>
std::string counted(Count count, std::string_view noun) {
  return std::to_string(count) + " " + std::string(noun) + (count == 1 ? "" : "s");
}

}  // namespace sonard
