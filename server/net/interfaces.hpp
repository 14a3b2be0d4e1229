// SPDX-License-Identifier: Apache-2.0
// The IPv4 addresses of this machine, for warnings about heads that no client can reach.
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

/// Addresses of all interfaces that are up. Empty if the OS does not list them.
std::vector<InterfaceAddress> interface_addresses();

/// The entry to which this address belongs: the entry with this address, or the loopback entry whose network
/// contains it (all of 127.0.0.0/8 is local). nullopt: not an address of this machine.
std::optional<InterfaceAddress> owner_of(Ipv4 address, const std::vector<InterfaceAddress>& interfaces);

/// An address of this machine, as configured.
struct OwnAddress {
  Ipv4 address = 0;
  Ipv4 netmask = 0;
  std::string interface {};  ///< the interface that gave it; empty: given as numbers
  /// Why the interface has no address, in words: "eth0 has no IPv4 address (yet)"; empty: it has one.
  std::string trouble{};
};

/// Parses "10.61.19.200", or the name of an interface, "eth0": the first of its addresses. An unknown name,
/// or an interface without an address, may be plugged in later, so the result has a `trouble`. nullopt:
/// neither an address nor a name.
std::optional<OwnAddress> parse_own_address(std::string_view text);
/// Parses "255.255.255.0", or the name of an interface: the mask of the first of its addresses. As
/// parse_own_address().
std::optional<OwnAddress> parse_own_netmask(std::string_view text);

/// The new address and netmask of a head whose address, netmask or both are given by interfaces; nullopt if
/// they are the same as before, or if the interfaces have no address. The address changes to the first of its
/// interface if the interface no longer has the current one.
/// @param interface empty: the address is given as numbers
/// @param netmask_interface empty: the netmask is given as numbers
/// @param current as the head serves now; its `interface` is ignored
std::optional<InterfaceAddress> followed(const std::string& interface, const std::string& netmask_interface,
                                         const InterfaceAddress& current,
                                         const std::vector<InterfaceAddress>& now);
/// "eth0: its address is 10.61.19.201 now", or its netmask, or both; for the log.
std::string followed_text(const InterfaceAddress& before, const InterfaceAddress& after);

/// Distinguishes addresses that this machine had from addresses that it never had.
class OwnAddresses {
 public:
  struct News {
    std::vector<Ipv4> gone, back;
  };
  /// @param own served addresses; 0 is all addresses, and is never gone
  /// @param now interface_addresses(); empty: unknown, no change
  News look(const std::vector<Ipv4>& own, const std::vector<InterfaceAddress>& now);

  /// Served addresses that existed and are gone.
  const std::set<Ipv4>& gone() const { return gone_; }

 private:
  std::set<Ipv4> here_, gone_;
};

}  // namespace sonard::server
