// SPDX-License-Identifier: Apache-2.0
#include "server/pose/udp_listener.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <bit>
#include <utility>

#include "server/net/addresses.hpp"
#include "server/pose/pose_source.hpp"

namespace sonard::server {

using boost::asio::ip::udp;
using boost::system::error_code;

UdpListener::UdpListener(boost::asio::io_context& io, std::string name, const Endpoint& bind, AllowList allow,
                         const Clock& clock)
    : name_(std::move(name)), local_(bind), allow_(std::move(allow)), clock_(clock), socket_(io) {}

void UdpListener::start(Handler handler) {
  handler_ = std::move(handler);
  error_code error;
  const auto check = [&](const char* operation) {
    if (error) {
      throw PoseSourceError(fmt::format("{}: {}: {}", description(), operation, error.message()));
    }
  };
  socket_.open(udp::v4(), error);
  check("open");
  socket_.bind({boost::asio::ip::address_v4{local_.address}, local_.port}, error);
  check("bind");
  const udp::endpoint bound = socket_.local_endpoint(error);
  check("local address");
  local_ = {bound.address().to_v4().to_uint(), bound.port()};
  receive();
}

void UdpListener::close() {
  error_code ignored;
  socket_.close(ignored);
}

Endpoint UdpListener::peer() const {
  return {peer_.address().to_v4().to_uint(), peer_.port()};
}

std::string UdpListener::description() const {
  return name_ + " " + endpoint_text(local_);
}

void UdpListener::receive() {
  socket_.async_receive_from(boost::asio::buffer(buffer_), peer_,
                             [self = shared_from_this()](const error_code& error, std::size_t length) {
                               if (!self->socket_.is_open()) {
                                 return;
                               }
                               // An error here is a report about one datagram (for example an ICMP answer).
                               if (!error) {
                                 self->on_received(length);
                               }
                               if (self->socket_.is_open()) {  // the handler may have closed it
                                 self->receive();
                               }
                             });
}

void UdpListener::on_received(std::size_t length) {
  const TimePoint arrival = clock_.now();
  if (allows(allow_, peer().address)) {
    handler_(std::span{buffer_}.first(length), arrival);
  } else if (std::has_single_bit(++refused_)) {
    spdlog::warn("{}: datagram from {} dropped: not in the allow list ({} so far)", description(),
                 endpoint_text(peer()), refused_);
  }
}

}  // namespace sonard::server
