// SPDX-License-Identifier: Apache-2.0
// The socket on which an Oculus tells that it is there.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <functional>

#include "protocol/common/endpoint.hpp"
#include "protocol/oculus/messages.hpp"

namespace sonard::client {

/// Belongs to the thread that runs the io_context, and outlives its handlers.
class StatusListener {
 public:
  using Received = std::function<void(const oculus::Status& status)>;

  /// Others may listen to the same port. @throws std::runtime_error naming it
  StatusListener(boost::asio::io_context& io, const Endpoint& bind, Received received);
  void close();

 private:
  void receive();

  boost::asio::ip::udp::socket socket_;
  Received received_;
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace sonard::client
