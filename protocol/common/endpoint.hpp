// SPDX-License-Identifier: Apache-2.0
// IPv4 addresses and ports as plain values.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>

namespace sonard {

/// IPv4 address, first octet most significant (127.0.0.1 = 0x7F000001).
using Ipv4 = std::uint32_t;

/// Address and port of a datagram's peer or of a socket.
struct Endpoint {
  Ipv4 address = 0;        ///< 0 binds all addresses
  std::uint16_t port = 0;  ///< 0 lets the kernel choose (bind only)

  /// By address, then port.
  auto operator<=>(const Endpoint&) const = default;
};

/// "127.0.0.1"
std::string address_text(Ipv4 address);
/// "127.0.0.1:14600"
std::string endpoint_text(const Endpoint& endpoint);

/// Host and port as a user types them.
struct HostAndPort {
  std::string host;        ///< name or address, not empty
  std::uint16_t port = 0;  ///< 1..65535
};

/// Parses "sonar.local:4001"; nullopt if `text` has another form.
std::optional<HostAndPort> parse_host_and_port(const std::string& text);

}  // namespace sonard
