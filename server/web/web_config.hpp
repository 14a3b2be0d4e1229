// SPDX-License-Identifier: Apache-2.0
// The section `web` of the configuration.
#pragma once

#include <string>
#include <vector>

#include "server/net/addresses.hpp"

namespace sonard::server {

/// The page in the browser and the metrics for monitors.
struct WebConfig {
  Endpoint bind;
  AllowList allow;
  std::string token;                 ///< clients that send it may change state; empty: only this machine may
  std::vector<std::string> origins;  ///< other sites whose pages may connect, "https://example.org"
  int max_viewers = 128;             ///< WebSockets at a time; 1 to 1000
  int max_viewers_per_peer = 64;     ///< of them with one address; 1 to 1000
};

}  // namespace sonard::server
