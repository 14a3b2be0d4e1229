// SPDX-License-Identifier: Apache-2.0
#include "server/net/tcp_port.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "server/net/frame_writer.hpp"
#include "server/net/tcp_listener.hpp"
#include "server/net/tcp_options.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

// Limits how much old data a client reads after a pause; a real line would buffer nothing.
constexpr int send_buffer_bytes = 16 << 10;

}  // namespace

struct TcpPort::Impl : std::enable_shared_from_this<TcpPort::Impl> {
  class Session;

  Impl(asio::io_context& io, const SerialTcpConfig& config, const Clock& used_clock)
      : listener(std::make_shared<TcpListener>(io, "serial tcp", config.bind, config.allow)),
        clock(used_clock) {}

  void admit(tcp::socket socket, const Endpoint& peer);
  bool make_room();
  void stop();
  std::string description() const { return "tcp " + endpoint_text(listener->local()); }

  std::shared_ptr<TcpListener> listener;
  const Clock& clock;
  SerialPortEvents events;
  std::set<std::shared_ptr<Session>> sessions;
  SerialPortCounters counters;
  PeerLog log;
};

/// A client. The port's set and each pending handler own it.
class TcpPort::Impl::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(std::shared_ptr<Impl> port, tcp::socket socket, const Endpoint& peer)
      : port_(std::move(port)),
        socket_(std::move(socket)),
        writer_(socket_),
        peer_("tcp " + endpoint_text(peer)),
        newest_bytes_(port_->clock.now()),
        ends_{WireTransport::tcp, peer, port_->listener->local(), {}} {}

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

  /// Time of the last bytes from it, or of its connection.
  TimePoint newest_bytes() const { return newest_bytes_; }

  /// Pending handlers find the socket closed.
  void close() {
    error_code ignored;
    socket_.close(ignored);
  }

  /// Closes it and reports it to the link.
  void leave(std::string_view why) {
    const auto self = shared_from_this();
    close();
    port_->sessions.erase(self);
    port_->log.info("serial {}: {} {}", port_->description(), peer_, why);
    if (port_->events.ended) {
      port_->events.ended(ends_);
    }
    port_->events.left(peer_);
  }

 private:
  void on_read(const error_code& error, std::size_t length) {
    if (!socket_.is_open()) {
      return;
    }
    if (error) {
      leave("disconnected");
      return;
    }
    newest_bytes_ = port_->clock.now();
    if (port_->events.takes(ends_.client.address)) {
      take({buffer_.data(), length});
    }
    if (socket_.is_open()) {
      read();
    }
  }

  void take(std::span<const std::uint8_t> bytes) {
    port_->counters.bytes_in += bytes.size();
    if (port_->events.passed) {
      port_->events.passed(ends_, /*to_client=*/false, bytes);
    }
    port_->events.received(bytes, peer_);
  }

  std::shared_ptr<Impl> port_;
  tcp::socket socket_;
  FrameWriter<tcp::socket> writer_;
  std::string peer_;
  TimePoint newest_bytes_;
  WireEnds ends_;
  std::array<std::uint8_t, serial_read_bytes> buffer_{};
};

/// Returns false if no client has been silent for most_silence.
bool TcpPort::Impl::make_room() {
  if (sessions.size() < most_clients) {
    return true;
  }
  const auto silent = *std::ranges::min_element(
      sessions, {}, [](const std::shared_ptr<Session>& session) { return session->newest_bytes(); });
  if (clock.now() - silent->newest_bytes() < most_silence) {
    return false;
  }
  silent->leave("was closed, because it was silent and another client needs its place");
  return true;
}

void TcpPort::Impl::admit(tcp::socket socket, const Endpoint& peer) {
  if (!make_room()) {
    listener->refuse(peer, "too many clients");
    return;
  }
  set_client_options(socket, send_buffer_bytes);
  ++counters.connections;
  log.info("serial {}: tcp {} connected", description(), endpoint_text(peer));
  const auto session = std::make_shared<Session>(shared_from_this(), std::move(socket), peer);
  sessions.insert(session);
  session->read();
}

void TcpPort::Impl::stop() {
  listener->close();
  for (const auto& session : sessions) {
    session->close();
  }
  sessions.clear();
}

TcpPort::TcpPort(asio::io_context& io, const SerialTcpConfig& config, const Clock& clock)
    : impl_(std::make_shared<Impl>(io, config, clock)) {
  impl_->listener->open();
}

TcpPort::~TcpPort() {
  impl_->stop();
}

void TcpPort::start(SerialPortEvents events) {
  impl_->events = std::move(events);
  impl_->listener->start([weak = impl_->weak_from_this()](tcp::socket socket, const Endpoint& peer) {
    if (const auto self = weak.lock()) {
      self->admit(std::move(socket), peer);
    }
  });
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
  SerialPortCounters counters = impl_->counters;
  counters.refused = impl_->listener->refused();
  return counters;
}

Endpoint TcpPort::local_endpoint() const {
  return impl_->listener->local();
}

}  // namespace sonard::server
