// SPDX-License-Identifier: Apache-2.0
#include "server/net/tcp_port.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>

#include <array>
#include <bit>
#include <chrono>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/net/addresses.hpp"
#include "server/net/frame_writer.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

// What a client that pauses finds when it goes on is old by up to so much; the line itself would hold
// nothing.
constexpr int send_buffer_bytes = 16 << 10;
// A silent peer is asked after half a minute and given up half a minute later.
constexpr int keepalive_idle_s = 30;
constexpr int keepalive_interval_s = 10;
constexpr int keepalive_probes = 3;
constexpr std::chrono::seconds accept_retry{1};

template <int Name>
using TcpOption = asio::detail::socket_option::integer<IPPROTO_TCP, Name>;

Endpoint to_endpoint(const tcp::endpoint& endpoint) {
  return {endpoint.address().to_v4().to_uint(), endpoint.port()};
}

void set_options(tcp::socket& socket) {
  error_code ignored;  // the peer may be gone already
  socket.non_blocking(true, ignored);
  socket.set_option(tcp::no_delay{true}, ignored);
  socket.set_option(tcp::socket::send_buffer_size{send_buffer_bytes}, ignored);
  socket.set_option(tcp::socket::keep_alive{true}, ignored);
  socket.set_option(TcpOption<TCP_KEEPIDLE>{keepalive_idle_s}, ignored);
  socket.set_option(TcpOption<TCP_KEEPINTVL>{keepalive_interval_s}, ignored);
  socket.set_option(TcpOption<TCP_KEEPCNT>{keepalive_probes}, ignored);
}

}  // namespace

struct TcpPort::Impl : std::enable_shared_from_this<TcpPort::Impl> {
  class Session;

  Impl(asio::io_context& io, SerialTcpConfig port_config)
      : config(std::move(port_config)), acceptor(io), retry(io) {}

  void open();
  void accept();
  void on_accepted(const error_code& error, tcp::socket socket);
  void admit(tcp::socket socket, const Endpoint& peer);
  void refuse(const Endpoint& peer, const char* reason);
  void stop();
  std::string description() const { return "tcp " + endpoint_text(local); }

  SerialTcpConfig config;
  tcp::acceptor acceptor;
  asio::steady_timer retry;
  Endpoint local;
  SerialPortEvents events;
  std::set<std::shared_ptr<Session>> sessions;
  SerialPortCounters counters;
  PeerLog log;
};

/// One client. The set of its port owns it, and so does each pending handler.
class TcpPort::Impl::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(std::shared_ptr<Impl> port, tcp::socket socket, const Endpoint& peer)
      : port_(std::move(port)),
        socket_(std::move(socket)),
        writer_(socket_),
        peer_("tcp " + endpoint_text(peer)),
        ends_{WireTransport::tcp, peer, port_->local, {}} {}

  void read() {
    socket_.async_read_some(asio::buffer(buffer_),
                            [self = shared_from_this()](const error_code& error, std::size_t length) {
                              self->on_read(error, length);
                            });
  }

  void send(std::span<const std::uint8_t> frame) {
    const FrameFate fate = writer_.send(frame, shared_from_this());
    if (count_frame(fate, frame.size(), port_->counters) && port_->events.passed) {
      port_->events.passed(ends_, /*to_client=*/true, frame);
    }
  }

  /// Pending handlers find the socket closed.
  void close() {
    error_code ignored;
    socket_.close(ignored);
  }

 private:
  void on_read(const error_code& error, std::size_t length) {
    if (!socket_.is_open()) {
      return;
    }
    if (error) {
      close();
      port_->sessions.erase(shared_from_this());
      port_->log.info("serial {}: {} left", port_->description(), peer_);
      if (port_->events.ended) {
        port_->events.ended(ends_);
      }
      port_->events.left(peer_);
      return;
    }
    port_->counters.bytes_in += length;
    if (port_->events.passed) {
      port_->events.passed(ends_, /*to_client=*/false, {buffer_.data(), length});
    }
    port_->events.received({buffer_.data(), length}, peer_);
    if (socket_.is_open()) {
      read();
    }
  }

  std::shared_ptr<Impl> port_;
  tcp::socket socket_;
  FrameWriter<tcp::socket> writer_;
  std::string peer_;
  WireEnds ends_;
  std::array<std::uint8_t, serial_read_bytes> buffer_{};
};

void TcpPort::Impl::open() {
  error_code error;
  const auto check = [&](const char* operation) {
    if (error) {
      throw SocketError(
          fmt::format("cannot {} TCP {}: {}", operation, endpoint_text(config.bind), error.message()));
    }
  };
  acceptor.open(tcp::v4(), error);
  check("open");
  // Connections of an earlier run that linger in TIME_WAIT must not block a restart. A live listener still
  // does.
  acceptor.set_option(tcp::acceptor::reuse_address{true}, error);
  check("set SO_REUSEADDR of");
  acceptor.bind({asio::ip::address_v4{config.bind.address}, config.bind.port}, error);
  check("bind");
  acceptor.listen(tcp::acceptor::max_listen_connections, error);
  check("listen on");
  const tcp::endpoint bound = acceptor.local_endpoint(error);
  check("use");
  local = to_endpoint(bound);
}

void TcpPort::Impl::accept() {
  acceptor.async_accept([self = shared_from_this()](const error_code& error, tcp::socket socket) {
    self->on_accepted(error, std::move(socket));
  });
}

void TcpPort::Impl::on_accepted(const error_code& error, tcp::socket socket) {
  if (!acceptor.is_open()) {
    return;
  }
  if (!error) {
    error_code gone;
    const tcp::endpoint peer = socket.remote_endpoint(gone);
    if (!gone) {
      admit(std::move(socket), to_endpoint(peer));
    }
    accept();
    return;
  }
  // Out of file descriptors, most likely: asking again at once would only spin.
  log.error("serial {}: accept: {}", description(), error.message());
  retry.expires_after(accept_retry);
  retry.async_wait([self = shared_from_this()](const error_code& cancelled) {
    if (!cancelled && self->acceptor.is_open()) {
      self->accept();
    }
  });
}

void TcpPort::Impl::admit(tcp::socket socket, const Endpoint& peer) {
  if (!allows(config.allow, peer.address)) {
    refuse(peer, "not in the allow list");
    return;
  }
  if (sessions.size() >= most_clients) {
    refuse(peer, "too many clients");
    return;
  }
  set_options(socket);
  ++counters.connections;
  log.info("serial {}: tcp {} connected", description(), endpoint_text(peer));
  const auto session = std::make_shared<Session>(shared_from_this(), std::move(socket), peer);
  sessions.insert(session);
  session->read();
}

void TcpPort::Impl::refuse(const Endpoint& peer, const char* reason) {
  if (std::has_single_bit(++counters.refused)) {
    spdlog::warn("serial {}: {} refused: {} ({} so far)", description(), endpoint_text(peer), reason,
                 counters.refused);
  }
}

void TcpPort::Impl::stop() {
  error_code ignored;
  acceptor.close(ignored);
  retry.cancel(ignored);
  for (const auto& session : sessions) {
    session->close();
  }
  sessions.clear();
}

TcpPort::TcpPort(asio::io_context& io, const SerialTcpConfig& config)
    : impl_(std::make_shared<Impl>(io, config)) {
  impl_->open();
}

TcpPort::~TcpPort() {
  impl_->stop();
}

void TcpPort::start(SerialPortEvents events) {
  impl_->events = std::move(events);
  impl_->accept();
}

void TcpPort::stop() {
  impl_->stop();
}

void TcpPort::send(std::span<const std::uint8_t> frame) {
  for (const auto& session : impl_->sessions) {
    session->send(frame);
  }
}

bool TcpPort::connected() const {
  return !impl_->sessions.empty();
}

std::string TcpPort::description() const {
  return impl_->description();
}

SerialPortCounters TcpPort::counters() const {
  return impl_->counters;
}

Endpoint TcpPort::local_endpoint() const {
  return impl_->local;
}

}  // namespace sonard::server
