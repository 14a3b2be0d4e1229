// SPDX-License-Identifier: Apache-2.0
// Range modes: the altitudes that a ping covers, and the rate of the pings (5).
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace sonard::dvl_a50 {

struct RangeMode {
  double least_m = 0.0, most_m = 0.0;  ///< altitude
  double rate_hz = 0.0;
};
using RangeModes = std::array<RangeMode, 5>;

/// The setting `range_mode`.
struct RangeChoice {
  int first = 0, last = 4;  ///< modes in which the device looks for the bottom
  bool water = false;       ///< water tracking
};
/// @return nullopt if the text is not "auto", "=a", "a<=b" or "wt" with modes from 0 to 4, a <= b
std::optional<RangeChoice> parse_range_mode(std::string_view text);

/// The mode after an altitude was measured: `mode` while it holds the altitude, else the lowest chosen mode
/// that does. nullopt: none does, so the bottom is lost. `mode` of the ping is nullopt in a search.
std::optional<int> next_mode(std::optional<int> mode, double altitude_m, const RangeChoice& choice,
                             const RangeModes& modes);

}  // namespace sonard::dvl_a50
