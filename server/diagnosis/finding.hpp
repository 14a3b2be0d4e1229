// SPDX-License-Identifier: Apache-2.0
// A likely error in a setup, reported to the user.
#pragma once

#include <string>

namespace sonard::server {

struct Finding {
  std::string code;          ///< for programs: "above_surface"
  std::string text;          ///< whole sentences: "The sonar is 25.6 m above the water surface (is z down?)."
  bool stops_pings = false;  ///< true if no head makes a ping while this lasts

  bool operator==(const Finding&) const = default;
};

}  // namespace sonard::server
