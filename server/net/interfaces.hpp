// SPDX-License-Identifier: Apache-2.0
// The IPv4 addresses of this machine, to tell a user about a head that no client could talk to.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/endpoint.hpp"

namespace sonard::server {

struct InterfaceAddress {
  std::string interface;
  Ipv4 address = 0;
  Ipv4 netmask = 0;
};

/// Addresses of all interfaces that are up. Empty when the OS does not tell.
std::vector<InterfaceAddress> interface_addresses();

/// The entry this address belongs to: the one that is this address, or, as all of 127.0.0.0/8 is local, the
/// loopback entry whose network it is in. nullopt: not an address of this machine.
std::optional<InterfaceAddress> owner_of(Ipv4 address, const std::vector<InterfaceAddress>& interfaces);

/// "10.61.19.200", or the name of an interface, "eth0": the first of its addresses. nullopt: neither.
std::optional<Ipv4> parse_own_address(std::string_view text);
/// "255.255.255.0", or the name of an interface: the mask of the first of its addresses. nullopt: neither.
std::optional<Ipv4> parse_own_netmask(std::string_view text);

}  // namespace sonard::server
