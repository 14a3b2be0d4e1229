// SPDX-License-Identifier: Apache-2.0
// Phrases for the damaged parts of a log, printed by `sonard info` and `sonard replay`.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "protocol/common/damage.hpp"

namespace sonard::server {

/// The size and place of a part: "40 bytes at byte 200", or "the first 8 bytes".
inline std::string place_text(const Damage& damage) {
  return damage.offset == 0 ? fmt::format("the first {} bytes", damage.size)
                            : fmt::format("{} bytes at byte {}", damage.size, damage.offset);
}

/// Appends a phrase for each part: its place, its size, and what is lost. After ten phrases, one more counts
/// the rest.
/// @param lost describes the loss of a part, for example "3 pings are lost"
template <class Part, class Lost>
void add_damage(std::vector<std::string>& problems, const std::vector<Part>& parts, const Lost& lost) {
  constexpr std::size_t most = 10;
  for (std::size_t i = 0; i < parts.size() && i < most; ++i) {
    const Damage& damage = parts[i];
    problems.push_back(fmt::format("damaged: {} cannot be read ({}); {}", place_text(damage),
                                   to_string(damage.error), lost(parts[i])));
  }
  if (parts.size() > most) {
    problems.push_back(fmt::format("damaged: {} more parts cannot be read", parts.size() - most));
  }
}

}  // namespace sonard::server
