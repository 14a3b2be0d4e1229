// SPDX-License-Identifier: Apache-2.0
// The two sockets of a client, opened like the vendor's libraries do (docs/protocols/gemini.md 1.1).
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>

namespace sonard::client {

/// A socket could not be opened; what() names the socket, the reason and what to check.
class SocketError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens port 52900 of `address` (0: all) for reports, with a buffer for several pings if the system allows.
/// @throws SocketError
boost::asio::ip::udp::socket open_report_socket(boost::asio::io_context& io, std::uint32_t address);

/// Opens port 52901 of `address` for commands.
/// @throws SocketError
boost::asio::ip::udp::socket open_command_socket(boost::asio::io_context& io, std::uint32_t address);

/// Reads the next datagram without waiting; nullopt if there is no datagram. Datagrams longer than `buffer`
/// are cut.
/// @param overflows set to the number of datagrams that the kernel dropped because the buffer was full
std::optional<std::size_t> receive(boost::asio::ip::udp::socket& socket, std::span<std::uint8_t> buffer,
                                   std::uint64_t& overflows);

/// The local address that the system would send from to `head`; 127.0.0.1 if `head` is on this machine,
/// because the head itself uses port 52901 there.
/// @throws SocketError (no route)
std::uint32_t address_towards(std::uint32_t head);

/// Netmask of the interface with `address`; nullopt if no interface has it.
std::optional<std::uint32_t> interface_netmask(std::uint32_t address);

}  // namespace sonard::client
