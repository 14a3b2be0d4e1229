// SPDX-License-Identifier: Apache-2.0
// The two sockets of a client, opened like the vendor's libraries do (protocol/gemini/README.md 1.1).
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/endpoint.hpp"

namespace sonard::client {

/// Errors of opening are std::runtime_error; what() names the socket, the reason and what to check.
class GeminiSockets {
 public:
  /// Opens port 52900 of `bind` (0: all addresses) for reports, with a buffer for several pings if the system
  /// allows, and port 52901 of `own` for commands. 0: call open_towards().
  GeminiSockets(Ipv4 bind, Ipv4 own);

  /// Opens the socket for commands, unless it is open, on the address that routes to `head`.
  void open_towards(Ipv4 head);
  /// The address that sends commands; 0: not known yet.
  Ipv4 own() const { return own_; }

  /// Becomes readable when a report arrives.
  int reports_descriptor() { return reports_.native_handle(); }
  /// The next datagram, without waiting. Valid until the next call; longer than 2048 bytes: cut.
  std::optional<std::span<const std::uint8_t>> receive();
  /// Datagrams that the kernel dropped because the receive buffer was full.
  std::uint64_t kernel_drops() const { return kernel_drops_; }
  boost::system::error_code send(Ipv4 head, std::span<const std::uint8_t> datagram);

 private:
  boost::asio::io_context io_;
  boost::asio::ip::udp::socket reports_;
  boost::asio::ip::udp::socket commands_;
  Ipv4 own_;
  std::vector<std::uint8_t> buffer_;
  std::uint64_t kernel_drops_ = 0;
};

/// The local address that the system would send from to `head`; 127.0.0.1 if `head` is on this machine,
/// because the head itself uses port 52901 there.
/// @throws std::runtime_error (no route)
Ipv4 address_towards(Ipv4 head);

/// Netmask of the interface with `address`; nullopt if no interface has it.
std::optional<Ipv4> interface_netmask(Ipv4 address);

}  // namespace sonard::client
