// SPDX-License-Identifier: Apache-2.0
// A likely error in a setup, reported to the user.
#pragma once

#include <string>

namespace sonard::server {

struct Finding {
  std::string code;  ///< for programs: "above_surface"
  std::string text;  ///< whole sentences: "The sonar is 25.6 m above the water surface (is z down?)."

  bool operator==(const Finding&) const = default;
};

/// Code for poses whose stamps do not move while pings wait for them: no ping is made.
inline constexpr const char* no_ping_by_stamps = "stamps_never_moved";

}  // namespace sonard::server
