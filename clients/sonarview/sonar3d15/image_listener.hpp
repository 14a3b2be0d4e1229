// SPDX-License-Identifier: Apache-2.0
// The socket that receives the images of a Sonar 3D-15.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "protocol/common/endpoint.hpp"

namespace sonard::client {

/// Joins the multicast group and takes unicast on its port, too. Use it on the thread of the io_context only.
/// It must outlive its handlers.
class ImageListener {
 public:
  using Received = std::function<void(const Endpoint& from, std::span<const std::uint8_t> datagram)>;

  /// Other programs may share the port.
  /// @param interface address of the interface to join on; 0: the system chooses
  /// @throws std::runtime_error that names the address
  ImageListener(boost::asio::io_context& io, Ipv4 interface, Received received);

 private:
  void receive();

  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint from_;
  Received received_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace sonard::client
