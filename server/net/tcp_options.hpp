// SPDX-License-Identifier: Apache-2.0
// Socket options of all client connections. (TcpListener detects vanished peers.)
#pragma once

#include <boost/asio/ip/tcp.hpp>

namespace sonard::server {

/// Sends at once, never blocks.
/// @param send_buffer_bytes limits how much old data a client reads after a pause
inline void set_client_options(boost::asio::ip::tcp::socket& socket, int send_buffer_bytes) {
  using boost::asio::ip::tcp;
  boost::system::error_code ignored;  // the peer may be gone already
  socket.non_blocking(true, ignored);
  socket.set_option(tcp::no_delay{true}, ignored);
  socket.set_option(tcp::socket::send_buffer_size{send_buffer_bytes}, ignored);
}

}  // namespace sonard::server
