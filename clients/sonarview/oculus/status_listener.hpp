// SPDX-License-Identifier: Apache-2.0
// The socket that receives the status broadcasts of an Oculus.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <functional>

#include "protocol/common/endpoint.hpp"
#include "protocol/oculus/messages.hpp"

namespace sonard::client {

/// Use it on the thread of the io_context only. It must outlive its handlers.
class StatusListener {
 public:
  using Received = std::function<void(const oculus::Status& status)>;

  /// Other programs may share the port. @throws std::runtime_error that names the address
  StatusListener(boost::asio::io_context& io, const Endpoint& bind, Received received);
  void close();

 private:
  void receive();

  boost::asio::ip::udp::socket socket_;
  Received received_;
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace sonard::client
