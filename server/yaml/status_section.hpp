// SPDX-License-Identifier: Apache-2.0
// The part of the loader that reads a head's address and the destinations of its status packets.
#pragma once

#include <string_view>

#include "server/net/addresses.hpp"
#include "server/net/interfaces.hpp"
#include "server/yaml/network_section.hpp"
#include "server/yaml/status_destination.hpp"
#include "server/yaml/yaml_section.hpp"

namespace sonard::server {

inline constexpr TextForm address_form{"an IPv4 address such as 127.0.0.2", "address", address_schema, true};
inline constexpr TextForm own_address_form{
    "an IPv4 address such as 127.0.0.2, or an interface of this machine such as eth0", "address or interface",
    R"("type": "string")", true};
inline constexpr TextForm netmask_form{
    "a netmask such as 255.255.255.0, or an interface of this machine such as eth0", "netmask or interface",
    R"("type": "string")"};
inline constexpr TextForm mac_form{"six hexadecimal octets such as 00:12:34:00:02:01", "six octets",
                                   mac_schema};

/// Reads a key with an address of this machine: numbers, or the name of its interface. The present value is
/// the default. @return the interface; empty: given as numbers
std::string read_own_address(YamlSection& section, std::string_view key, Ipv4& address,
                             std::string_view meaning);
/// Reads a key with the netmask of a network of this machine: numbers, or the name of an interface.
std::string read_own_netmask(YamlSection& section, std::string_view key, Ipv4& netmask,
                             std::string_view meaning);
/// Reports an address that cannot be the address of one host.
void check_host_address(YamlSection& section, std::string_view key, Ipv4 address);
/// Checks the key `netmask` beside `address_key`: reports an invalid mask, and an address that is not the
/// address of one host under it.
void check_inside_network(YamlSection& section, std::string_view address_key, Ipv4 address, Ipv4 netmask);
/// The key `status` of a head with the address of `address_key` under `netmask`.
void read_status_destination(YamlSection& section, std::string_view address_key, Ipv4 netmask,
                             StatusDestination& status);
/// Warns of hosts that receive status packets but are not allowed to use the head.
void warn_of_status_without_access(YamlSection& section, const StatusDestination& status,
                                   const AllowList& allow);

}  // namespace sonard::server
