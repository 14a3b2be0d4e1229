// SPDX-License-Identifier: Apache-2.0
// IPv4 addresses as text: "127.0.0.2", "127.0.0.0/8", "127.0.0.1:14600", "00:12:34:00:02:01".
// Strict: no spaces, no names, no trailing text.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/endpoint.hpp"

namespace sonard::server {

/// A block of addresses, "127.0.0.0/8".
struct Cidr {
  Ipv4 network = 0;        ///< host bits are zero
  int prefix_length = 32;  ///< 0..32

  bool contains(Ipv4 address) const;
  bool operator==(const Cidr&) const = default;
};

/// Addresses that a socket accepts. Datagrams and connections from other addresses are counted and dropped.
using AllowList = std::vector<Cidr>;

/// True if one of the blocks contains the address; false for an empty list.
bool allows(const AllowList& list, Ipv4 address);

std::optional<Ipv4> parse_ipv4(std::string_view text);
/// "address/length" with zero host bits, or a single address, which is a block of one.
std::optional<Cidr> parse_cidr(std::string_view text);
/// "address:port".
std::optional<Endpoint> parse_endpoint(std::string_view text);
/// Six octets of two hexadecimal digits, separated by colons.
std::optional<std::array<std::uint8_t, 6>> parse_mac(std::string_view text);

std::string cidr_text(const Cidr& block);

/// The mask of a prefix length in 0..32.
Ipv4 netmask_of(int prefix_length);
/// Number of leading ones; nullopt if the mask has a hole.
std::optional<int> prefix_length_of(Ipv4 netmask);

inline bool is_loopback(Ipv4 address) {
  return address >> 24 == 127;
}
inline bool is_multicast(Ipv4 address) {
  return address >> 28 == 0xE;
}

}  // namespace sonard::server
