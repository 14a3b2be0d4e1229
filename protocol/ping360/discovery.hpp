// SPDX-License-Identifier: Apache-2.0
// Discovery of a Ping360 on Ethernet: text datagrams to and from its port 30303, as pure functions.
// Source: protocol/ping360/README.md 5.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "protocol/common/endpoint.hpp"

namespace sonard::ping360 {

inline constexpr std::uint16_t discovery_port = 30303;

/// True if a datagram is a discovery request. Ignores blanks and line ends around the word.
bool is_discovery(std::span<const std::uint8_t> datagram);

/// The answer to a discovery request, for its sender: four lines, each ended by CR LF.
/// @param mac MAC address of the head
/// @param address address of the head's data port
std::string discovery_reply(const std::array<std::uint8_t, 6>& mac, Ipv4 address);

/// The new address in a datagram "SetSS1IP ddd.ddd.ddd.ddd"; 0 requests DHCP and is not answered. nullopt if
/// the datagram is not such a command.
std::optional<Ipv4> set_ip(std::span<const std::uint8_t> datagram);

}  // namespace sonard::ping360
