// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/range_mode.hpp"

namespace sonard::dvl_a50 {

std::optional<RangeChoice> parse_range_mode(std::string_view text) {
  const auto mode_at = [&](std::size_t place) { return text[place] - '0'; };
  const auto is_mode = [&](std::size_t place) { return mode_at(place) >= 0 && mode_at(place) <= 4; };
  if (text == "auto") {
    return RangeChoice{};
  }
  if (text == "wt") {
    return RangeChoice{.water = true};
  }
  if (text.size() == 2 && text[0] == '=' && is_mode(1)) {
    return RangeChoice{mode_at(1), mode_at(1)};
  }
  if (text.size() == 4 && text.substr(1, 2) == "<=" && is_mode(0) && is_mode(3) && text[0] <= text[3]) {
    return RangeChoice{mode_at(0), mode_at(3)};
  }
  return std::nullopt;
}

std::optional<int> next_mode(std::optional<int> mode, double altitude_m, const RangeChoice& choice,
                             const RangeModes& modes) {
  const auto holds = [&](int number) {
    const RangeMode& limits = modes[static_cast<std::size_t>(number)];
    return number >= choice.first && number <= choice.last && altitude_m >= limits.least_m &&
           altitude_m <= limits.most_m;
  };
  if (mode && holds(*mode)) {
    return mode;
  }
  for (int number = choice.first; number <= choice.last; ++number) {
    if (holds(number)) {
      return number;
    }
  }
  return std::nullopt;
}

}  // namespace sonard::dvl_a50
