// SPDX-License-Identifier: Apache-2.0
// How a Ping360 on Ethernet is found: text in datagrams to and from its port 30303, as pure functions.
// Source: docs/protocols/ping360.md 5.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "protocol/common/endpoint.hpp"

namespace sonard::ping360 {

inline constexpr std::uint16_t discovery_port = 30303;

/// Whether a datagram asks who is there. Blanks and line ends around the word do not matter.
bool is_discovery(std::span<const std::uint8_t> datagram);

/// The answer, to be sent to whoever asked: exactly four lines, each ended by CR LF.
/// @param mac of ours
/// @param address of ours, where the data port answers
std::string discovery_reply(const std::array<std::uint8_t, 6>& mac, Ipv4 address);

/// The address that a datagram tells the head to take: "SetSS1IP ddd.ddd.ddd.ddd"; 0: it is to ask DHCP,
/// which is not answered. nullopt: it is no such order.
std::optional<Ipv4> set_ip(std::span<const std::uint8_t> datagram);

}  // namespace sonard::ping360
