// SPDX-License-Identifier: Apache-2.0
#include "server/pose/udp_listener.hpp"

#include <spdlog/spdlog.h>

#include <bit>
#include <utility>

#include "protocol/pose/pose_codec.hpp"
#include "server/error/error.hpp"

namespace sonard::server {

UdpListener::UdpListener(boost::asio::io_context& io, std::string name, const Endpoint& bind, AllowList allow,
                         const Clock& clock)
    : io_(io), name_(std::move(name)), local_(bind), allow_(std::move(allow)), clock_(clock) {}

void UdpListener::start(Handler handler) {
  try {
    socket_.emplace(io_, local_, UdpEndpoint::Sharing::alone, pose::max_message_bytes);
  } catch (const SocketError& error) {
    throw Error(ErrorKind::network, name_ + ": " + error.what(), "poses");
  }
  local_ = socket_->local_endpoint();
  open_ = true;
  socket_->start([this, handler = std::move(handler)](const Datagram& datagram) { take(datagram, handler); });
}

void UdpListener::close() {
  open_ = false;
  if (socket_) {
    socket_->close();
  }
}

std::string UdpListener::description() const {
  return name_ + " " + endpoint_text(local_);
}

void UdpListener::take(const Datagram& datagram, const Handler& handler) {
  peer_ = datagram.remote;
  if (allows(allow_, peer_.address)) {
    handler(datagram.bytes, clock_.now());
  } else if (std::has_single_bit(++refused_)) {
    spdlog::warn("{}: datagram from {} dropped: not in the allow list ({} so far)", description(),
                 endpoint_text(peer_), refused_);
  }
}

}  // namespace sonard::server
