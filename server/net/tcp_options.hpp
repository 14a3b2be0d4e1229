// SPDX-License-Identifier: Apache-2.0
// What all connections of clients have in common.
#pragma once

#include <netinet/in.h>
#include <netinet/tcp.h>

#include <boost/asio/ip/tcp.hpp>

namespace sonard::server {

/// Nothing waits for more, nothing blocks, and a peer that has vanished without a word is given up within a
/// minute: a silent one is asked after half of it.
/// @param send_buffer_bytes what a client that pauses finds when it goes on is old by up to so much
inline void set_client_options(boost::asio::ip::tcp::socket& socket, int send_buffer_bytes) {
  using boost::asio::ip::tcp;
  using Idle = boost::asio::detail::socket_option::integer<IPPROTO_TCP, TCP_KEEPIDLE>;
  using Interval = boost::asio::detail::socket_option::integer<IPPROTO_TCP, TCP_KEEPINTVL>;
  using Probes = boost::asio::detail::socket_option::integer<IPPROTO_TCP, TCP_KEEPCNT>;
  boost::system::error_code ignored;  // the peer may be gone already
  socket.non_blocking(true, ignored);
  socket.set_option(tcp::no_delay{true}, ignored);
  socket.set_option(tcp::socket::send_buffer_size{send_buffer_bytes}, ignored);
  socket.set_option(tcp::socket::keep_alive{true}, ignored);
  socket.set_option(Idle{30}, ignored);
  socket.set_option(Interval{10}, ignored);
  socket.set_option(Probes{3}, ignored);
}

}  // namespace sonard::server
