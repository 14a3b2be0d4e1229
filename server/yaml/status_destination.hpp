// SPDX-License-Identifier: Apache-2.0
// The destinations of a head's status packets.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/common/endpoint.hpp"

namespace sonard::server {

/// Destination of a head's status packets.
struct StatusDestination {
  enum class Mode : std::uint8_t {
    limited_broadcast,   ///< 255.255.255.255, as the devices do
    directed_broadcast,  ///< the broadcast address of the head's address under its netmask
    unicast,             ///< each of `hosts`
  };
  Mode mode = Mode::limited_broadcast;
  std::vector<Ipv4> hosts;  ///< for `unicast` only; then not empty
};

/// Destination addresses of the status packets.
std::vector<Ipv4> status_hosts(const StatusDestination& status, Ipv4 address, Ipv4 netmask);
/// "by limited broadcast", "to 127.0.0.1".
std::string status_text(const StatusDestination& status, Ipv4 address, Ipv4 netmask);

}  // namespace sonard::server
