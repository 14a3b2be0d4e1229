// SPDX-License-Identifier: Apache-2.0
// Something that looks wrong, for the person who set it up.
#pragma once

#include <string>

namespace sonard::server {

struct Finding {
  std::string code;  ///< for programs: "above_surface"
  std::string text;  ///< whole sentences: "The sonar is 25.6 m above the water surface (is z down?)."

  bool operator==(const Finding&) const = default;
};

/// Of poses whose stamps stand still while pings wait for them to move: no ping is made.
inline constexpr const char* no_ping_by_stamps = "stamps_never_moved";

}  // namespace sonard::server
