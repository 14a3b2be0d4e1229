// SPDX-License-Identifier: Apache-2.0
// A socket that the configuration asks for, before it is opened.
#pragma once

#include <cstdint>
#include <string>

#include "server/net/addresses.hpp"

namespace sonard::server {

/// A socket in the configuration.
struct PlannedSocket {
  enum class Transport : std::uint8_t { udp, tcp };
  Transport transport = Transport::udp;
  Endpoint endpoint;
  std::string key;  ///< "heads[0].network.bind", or "network.bind" in a list for one head
};

}  // namespace sonard::server
