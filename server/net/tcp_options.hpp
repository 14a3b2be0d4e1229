// SPDX-License-Identifier: Apache-2.0
// What all connections of clients have in common. (TcpListener finds those whose peer has vanished.)
#pragma once

#include <boost/asio/ip/tcp.hpp>

namespace sonard::server {

/// Nothing waits for more, nothing blocks.
/// @param send_buffer_bytes what a client that pauses finds when it goes on is old by up to so much
inline void set_client_options(boost::asio::ip::tcp::socket& socket, int send_buffer_bytes) {
  using boost::asio::ip::tcp;
  boost::system::error_code ignored;  // the peer may be gone already
  socket.non_blocking(true, ignored);
  socket.set_option(tcp::no_delay{true}, ignored);
  socket.set_option(tcp::socket::send_buffer_size{send_buffer_bytes}, ignored);
}

}  // namespace sonard::server
