// SPDX-License-Identifier: Apache-2.0
// The IPv4 addresses of this machine, to tell a user about a head that no client could talk to.
#pragma once

#include <optional>
#include <set>
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

/// An address of this machine as a configuration gives it.
struct OwnAddress {
  Ipv4 address = 0;
  Ipv4 netmask = 0;
  std::string interface {};  ///< by whose name it was given; empty: as numbers
  /// Why the interface has none, in words: "eth0 has no IPv4 address (yet)"; empty: it has.
  std::string trouble{};
};

/// "10.61.19.200", or the name of an interface, "eth0": the first of its addresses. A name that no interface
/// has, and one of an interface without an address, may be that of one which is not plugged in yet: they have
/// a `trouble`. nullopt: neither an address nor a name.
std::optional<OwnAddress> parse_own_address(std::string_view text);
/// "255.255.255.0", or the name of an interface: the mask of the first of its addresses. Likewise.
std::optional<OwnAddress> parse_own_netmask(std::string_view text);

/// The address that a head takes which is named by its interface and has an address: nullopt as long as the
/// interface has that, or none at all; else the first of it.
/// @param interface empty: the head is not named by one
std::optional<InterfaceAddress> followed(const std::string& interface, Ipv4 address,
                                         const std::vector<InterfaceAddress>& now);

/// Tells addresses that this machine had from those that it never had.
class OwnAddresses {
 public:
  struct News {
    std::vector<Ipv4> gone, back;
  };
  /// @param own that are served; 0 is all of them, which never goes
  /// @param now interface_addresses(); empty: not known, and nothing changes
  News look(const std::vector<Ipv4>& own, const std::vector<InterfaceAddress>& now);

  /// Those served that were here and are not.
  const std::set<Ipv4>& gone() const { return gone_; }

 private:
  std::set<Ipv4> here_, gone_;
};

}  // namespace sonard::server
