// SPDX-License-Identifier: Apache-2.0
#include "server/yaml/status_destination.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sonard::server {

std::vector<Ipv4> status_hosts(const StatusDestination& status, Ipv4 address, Ipv4 netmask) {
  using Mode = StatusDestination::Mode;
  constexpr Ipv4 limited_broadcast = 0xFFFFFFFF;
  switch (status.mode) {
    case Mode::limited_broadcast:
      return {limited_broadcast};
    case Mode::directed_broadcast:
      return {address | ~netmask};
    case Mode::unicast:
      break;
  }
  return status.hosts;
}

std::string status_text(const StatusDestination& status, Ipv4 address, Ipv4 netmask) {
  using Mode = StatusDestination::Mode;
  std::vector<std::string> hosts;
  for (const Ipv4 host : status_hosts(status, address, netmask)) {
    hosts.push_back(address_text(host));
  }
  switch (status.mode) {
    case Mode::limited_broadcast:
      return "by limited broadcast";
    case Mode::directed_broadcast:
      return "by broadcast to " + hosts.front();
    case Mode::unicast:
      break;
  }
  return fmt::format("to {}", fmt::join(hosts, ", "));
}

}  // namespace sonard::server
