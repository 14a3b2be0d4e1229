// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/oculus/status_listener.hpp"

#include <boost/asio/buffer.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "protocol/oculus/codec.hpp"

namespace sonard::client {

using boost::asio::ip::udp;
using boost::system::error_code;

StatusListener::StatusListener(boost::asio::io_context& io, const Endpoint& bind, Received received)
    : socket_(io), received_(std::move(received)) {
  error_code error;
  socket_.open(udp::v4(), error);
  if (!error) {
    socket_.set_option(udp::socket::reuse_address{true}, error);
  }
  if (!error) {
    socket_.bind({boost::asio::ip::address_v4{bind.address}, bind.port}, error);
  }
  if (error) {
    throw std::runtime_error("cannot receive status packets on UDP " + endpoint_text(bind) + ": " +
                             error.message());
  }
  receive();
}

void StatusListener::receive() {
  socket_.async_receive(boost::asio::buffer(buffer_), [this](const error_code& error, std::size_t length) {
    if (error || !socket_.is_open()) {
      return;
    }
    if (const auto status = oculus::decode_status(std::span(buffer_).first(length))) {
      received_(*status);
    }
    if (socket_.is_open()) {
      receive();
    }
  });
}

void StatusListener::close() {
  error_code ignored;
  socket_.close(ignored);
}

}  // namespace sonard::client
