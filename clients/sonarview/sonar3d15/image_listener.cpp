// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/sonar3d15/image_listener.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/multicast.hpp>
#include <stdexcept>
#include <utility>

#include "protocol/sonar3d15/device_config.hpp"

namespace sonard::client {

using boost::asio::ip::address_v4;
using boost::asio::ip::udp;
using boost::system::error_code;

namespace {

constexpr int receive_buffer_bytes = 1 << 20;  // more than a second of images

}  // namespace

ImageListener::ImageListener(boost::asio::io_context& io, Ipv4 interface, Received received)
    : socket_(io), received_(std::move(received)), buffer_(sonar3d15::most_packet_size) {
  const Endpoint group = sonar3d15::multicast_group;
  error_code error;
  socket_.open(udp::v4(), error);
  const auto set = [&](const auto& option) {
    if (!error) {
      socket_.set_option(option, error);
    }
  };
  set(udp::socket::reuse_address{true});
  set(udp::socket::receive_buffer_size{receive_buffer_bytes});
  if (!error) {
    socket_.bind({address_v4::any(), group.port}, error);
  }
  set(boost::asio::ip::multicast::join_group{address_v4{group.address}, address_v4{interface}});
  if (error) {
    throw std::runtime_error("cannot receive images of " + endpoint_text(group) + ": " + error.message() +
                             " (give the address of an interface as --interface)");
  }
  receive();
}

void ImageListener::receive() {
  socket_.async_receive_from(
      boost::asio::buffer(buffer_), from_, [this](const error_code& error, std::size_t length) {
        if (error == boost::asio::error::operation_aborted || !socket_.is_open()) {
          return;
        }
        if (!error) {
          received_({from_.address().to_v4().to_uint(), from_.port()}, std::span(buffer_).first(length));
        }
        receive();
      });
}

}  // namespace sonard::client
