// SPDX-License-Identifier: Apache-2.0
// The two sockets of a topside, opened as the libraries of a vehicle open them
// (docs/protocols/gemini.md 1.1).
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>

namespace sonard::client {

/// A socket cannot be had; what() says which, why, and what to look at.
class SocketError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Receives on port 52900 of `address` (0: of all), with a buffer for several pings where the system allows.
/// @throws SocketError
boost::asio::ip::udp::socket open_report_socket(boost::asio::io_context& io, std::uint32_t address);

/// Sends from port 52901 of `address`.
/// @throws SocketError
boost::asio::ip::udp::socket open_command_socket(boost::asio::io_context& io, std::uint32_t address);

/// Takes the next datagram without waiting; nullopt when there is none. What is longer than `buffer` is cut.
/// `overflows`: datagrams that the kernel has dropped so far because the buffer of the socket was full.
std::optional<std::size_t> receive(boost::asio::ip::udp::socket& socket, std::span<std::uint8_t> buffer,
                                   std::uint64_t& overflows);

/// The local address that the system would send from to `head`; 127.0.0.1 when `head` is of this machine,
/// since the head itself holds port 52901 there.
/// @throws SocketError (no route)
std::uint32_t address_towards(std::uint32_t head);

/// Netmask of the interface that has `address`; nullopt when none has.
std::optional<std::uint32_t> interface_netmask(std::uint32_t address);

}  // namespace sonard::client
