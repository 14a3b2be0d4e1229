// SPDX-License-Identifier: Apache-2.0
#include "server/net/tcp_listener.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>

#include <bit>
#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/net/udp_endpoint.hpp"

namespace sonard::server {

using boost::asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::chrono::seconds accept_retry{1};
// A silent peer is probed after half a minute and given up half a minute later.
constexpr int keepalive_idle_s = 30;
constexpr int keepalive_interval_s = 10;
constexpr int keepalive_probes = 3;
// How long the kernel retransmits unacknowledged data; the default is a quarter of an hour.
constexpr int unacknowledged_ms = 30'000;

template <int Name>
using TcpOption = boost::asio::detail::socket_option::integer<IPPROTO_TCP, Name>;

void notice_a_vanished_peer(tcp::socket& socket) {
  error_code ignored;  // the peer may be gone already
  socket.set_option(tcp::socket::keep_alive{true}, ignored);
  socket.set_option(TcpOption<TCP_KEEPIDLE>{keepalive_idle_s}, ignored);
  socket.set_option(TcpOption<TCP_KEEPINTVL>{keepalive_interval_s}, ignored);
  socket.set_option(TcpOption<TCP_KEEPCNT>{keepalive_probes}, ignored);
  socket.set_option(TcpOption<TCP_USER_TIMEOUT>{unacknowledged_ms}, ignored);
}

Endpoint to_endpoint(const tcp::endpoint& endpoint) {
  return {endpoint.address().to_v4().to_uint(), endpoint.port()};
}

}  // namespace

void TcpListener::open() {
  error_code error;
  const auto check = [&](const char* operation) {
    if (error) {
      throw_socket_error(fmt::format("{} TCP {}", operation, endpoint_text(local_)), error.value());
    }
  };
  acceptor_.open(tcp::v4(), error);
  check("open");
  // Connections of an earlier run in TIME_WAIT must not block a restart. A live listener still does.
  acceptor_.set_option(tcp::acceptor::reuse_address{true}, error);
  check("set SO_REUSEADDR of");
  acceptor_.bind({boost::asio::ip::address_v4{local_.address}, local_.port}, error);
  check("bind");
  acceptor_.listen(tcp::acceptor::max_listen_connections, error);
  check("listen on");
  const tcp::endpoint bound = acceptor_.local_endpoint(error);
  check("use");
  local_ = to_endpoint(bound);
}

void TcpListener::start(Accepted accepted) {
  accepted_ = std::move(accepted);
  accept();
}

void TcpListener::accept() {
  acceptor_.async_accept([self = shared_from_this()](const error_code& error, tcp::socket socket) {
    self->on_accepted(error, std::move(socket));
  });
}

void TcpListener::on_accepted(const error_code& error, tcp::socket socket) {
  if (!acceptor_.is_open()) {
    return;
  }
  if (!error) {
    error_code gone;
    const Endpoint peer = to_endpoint(socket.remote_endpoint(gone));
    if (!gone && allows(allow_, peer.address)) {
      notice_a_vanished_peer(socket);
      accepted_(std::move(socket), peer);
    } else if (!gone) {
      refuse(peer, "not in the allow list");
    }
    accept();
    return;
  }
  // Probably out of file descriptors: retrying at once would only spin.
  log_.error("{}: cannot accept a connection: {}", description(), error.message());
  retry_.expires_after(accept_retry);
  retry_.async_wait([self = shared_from_this()](const error_code& cancelled) {
    if (!cancelled && self->acceptor_.is_open()) {
      self->accept();
    }
  });
}

void TcpListener::refuse(const Endpoint& peer, const char* reason) {
  ++refused_;
  if (const std::uint64_t count = refusals_.count(reason); std::has_single_bit(count)) {
    spdlog::warn("{}: {} refused: {} ({} so far)", description(), endpoint_text(peer), reason, count);
  }
}

void TcpListener::close() {
  error_code ignored;
  acceptor_.close(ignored);
  retry_.cancel();
}

}  // namespace sonard::server
