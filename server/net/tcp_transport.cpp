// SPDX-License-Identifier: Apache-2.0
#include "server/net/tcp_transport.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>

#include "server/net/tcp_listener.hpp"
#include "server/net/tcp_options.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr int message_buffer_bytes = 256 << 10;
constexpr std::size_t read_bytes = 4096;

}  // namespace

struct TcpTransport::Impl : std::enable_shared_from_this<TcpTransport::Impl> {
  class Session;

  Impl(asio::io_context& used_io, const TcpTransportConfig& config, const Clock& used_clock)
      : io(used_io),
        clock(used_clock),
        allow(config.allow),
        stall_limit(config.stall_limit),
        listener(std::make_shared<TcpListener>(io, "tcp", config.bind, config.allow)) {}

  void listen();

  void admit(tcp::socket socket, const Endpoint& remote);
  void close_stalled();
  void close(const std::shared_ptr<Session>& session);
  void left(const std::shared_ptr<Session>& session);
  std::shared_ptr<Session> find(const Peer& peer) const;
  void stop();

  asio::io_context& io;
  const Clock& clock;
  AllowList allow;
  std::chrono::nanoseconds stall_limit;
  std::shared_ptr<TcpListener> listener;
  TransportEvents events;
  std::vector<std::shared_ptr<Session>> sessions;
  bool started = false;
  std::uint64_t connections = 0;
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
  std::uint64_t dropped = 0;
  std::uint64_t lost = 0;
};

/// A client. The transport's list and each pending handler own it.
class TcpTransport::Impl::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(std::shared_ptr<Impl> transport, tcp::socket socket, const Endpoint& remote)
      : transport_(std::move(transport)),
        socket_(std::move(socket)),
        ends_{WireTransport::tcp, remote, transport_->listener->local(), {}} {
    error_code gone;
    const tcp::endpoint local = socket_.local_endpoint(gone);
    if (!gone) {
      ends_.head = {local.address().to_v4().to_uint(), local.port()};
    }
  }

  Peer peer() const { return {0, ends_.client, ends_.head.address}; }
  const WireEnds& ends() const { return ends_; }

  void read() {
    socket_.async_read_some(asio::buffer(buffer_),
                            [self = shared_from_this()](const error_code& error, std::size_t length) {
                              self->on_read(error, length);
                            });
  }

  void send(const SharedBytes& message) {
    const bool has_room = waiting_.empty() || (message.size() <= short_message_bytes &&
                                               waiting_bytes_ + message.size() <= most_waiting_bytes);
    if (!has_room) {
      ++transport_->dropped;
      return;
    }
    pass(message, /*to_client=*/true);
    waiting_.push_back(message);
    if (waiting_.size() == 1) {
      write();
    } else {
      waiting_bytes_ += message.size();
    }
  }

  bool is_open() const { return socket_.is_open(); }
  /// Whether the client has not taken a message for this long.
  bool stalls_for(std::chrono::nanoseconds time) const {
    return !waiting_.empty() && transport_->clock.now() - write_begun_at_ >= time;
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
      transport_->left(shared_from_this());
      return;
    }
    transport_->bytes_in += length;
    const SharedBytes bytes(
        std::vector<std::uint8_t>(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(length)));
    pass(bytes, /*to_client=*/false);
    transport_->events.received({peer(), bytes});
    if (socket_.is_open()) {
      read();
    }
  }

  void write() {
    const SharedBytes& message = waiting_.front();
    write_begun_at_ = transport_->clock.now();
    asio::async_write(socket_, asio::buffer(message.data(), message.size()),
                      [self = shared_from_this()](const error_code& error, std::size_t length) {
                        self->on_written(error, length);
                      });
  }

  // Errors of the stream are left to its reader, which ends the session.
  void on_written(const error_code& error, std::size_t length) {
    transport_->bytes_out += length;
    if (error) {
      transport_->lost += waiting_.size();
      waiting_.clear();
      return;
    }
    waiting_.pop_front();
    if (!waiting_.empty()) {
      waiting_bytes_ -= waiting_.front().size();
      write();
    }
  }

  void pass(const SharedBytes& bytes, bool to_client) const {
    if (transport_->events.passed) {
      transport_->events.passed({to_client, WireTransport::tcp, {}, {{ends_.client, ends_.head, bytes}}});
    }
  }

  std::shared_ptr<Impl> transport_;
  tcp::socket socket_;
  WireEnds ends_;
  std::deque<SharedBytes> waiting_;  ///< the first is being sent
  std::size_t waiting_bytes_ = 0;    ///< of the messages after the first
  TimePoint write_begun_at_{};       ///< of the first
  std::array<std::uint8_t, read_bytes> buffer_{};
};

void TcpTransport::Impl::listen() {
  listener->start([weak = weak_from_this()](tcp::socket socket, const Endpoint& remote) {
    if (const auto self = weak.lock()) {
      self->admit(std::move(socket), remote);
    }
  });
}

void TcpTransport::Impl::close_stalled() {
  const auto present = sessions;  // a copy, because left() changes the list
  for (const auto& session : present) {
    if (session->stalls_for(most_stall)) {
      session->close();
      left(session);
    }
  }
}

void TcpTransport::Impl::admit(tcp::socket socket, const Endpoint& remote) {
  close_stalled();
  if (sessions.size() >= most_clients) {
    listener->refuse(remote, "too many clients");
    return;
  }
  set_client_options(socket, message_buffer_bytes);
  ++connections;
  const auto session = std::make_shared<Session>(shared_from_this(), std::move(socket), remote);
  sessions.push_back(session);
  // Posted, so that departures are reported before arrivals.
  asio::post(io, [self = shared_from_this(), session] {
    if (session->is_open()) {
      if (self->events.came) {
        self->events.came({session->peer()});
      }
      session->read();
    }
  });
}

void TcpTransport::Impl::left(const std::shared_ptr<Session>& session) {
  std::erase(sessions, session);
  if (events.ended) {
    events.ended(session->ends());
  }
  events.gone({session->peer()});
}

std::shared_ptr<TcpTransport::Impl::Session> TcpTransport::Impl::find(const Peer& peer) const {
  const auto found = std::ranges::find_if(
      sessions, [&](const auto& session) { return session->peer().remote == peer.remote; });
  return found == sessions.end() ? nullptr : *found;
}

// Reports the departure after the caller has returned.
void TcpTransport::Impl::close(const std::shared_ptr<Session>& session) {
  session->close();
  asio::post(io, [weak = weak_from_this(), session] {
    const auto self = weak.lock();
    if (self && std::ranges::count(self->sessions, session) > 0) {
      self->left(session);
    }
  });
}

void TcpTransport::Impl::stop() {
  listener->close();
  for (const auto& session : sessions) {
    session->close();
  }
  sessions.clear();
}

TcpTransport::TcpTransport(asio::io_context& io, const TcpTransportConfig& config, const Clock& clock)
    : impl_(std::make_shared<Impl>(io, config, clock)) {
  impl_->listener->open();
}

TcpTransport::~TcpTransport() {
  impl_->stop();
}

void TcpTransport::start(TransportEvents events) {
  impl_->events = std::move(events);
  impl_->started = true;
  impl_->listen();
}

void TcpTransport::rebind(const Endpoint& bind) {
  const auto moved = std::make_shared<TcpListener>(impl_->io, "tcp", bind, impl_->allow);
  moved->open();
  std::exchange(impl_->listener, moved)->close();
  const auto sessions = impl_->sessions;  // a copy, because left() changes the list
  for (const auto& session : sessions) {
    session->close();
    impl_->left(session);
  }
  if (impl_->started) {
    impl_->listen();
  }
}

void TcpTransport::stop() {
  impl_->stop();
}

void TcpTransport::send(std::vector<Outgoing> messages) {
  for (const Outgoing& message : messages) {
    if (message.to == Outgoing::To::everybody || message.bytes.size() == 0) {
      continue;
    }
    const auto session = impl_->find(message.peer);
    if (!session) {
      ++impl_->lost;
    } else if (impl_->stall_limit > std::chrono::nanoseconds{0} && session->stalls_for(impl_->stall_limit)) {
      ++impl_->dropped;
      impl_->close(session);
    } else {
      session->send(message.bytes);
    }
  }
}

void TcpTransport::disconnect(const Peer& client) {
  if (const auto session = impl_->find(client)) {
    impl_->close(session);
  }
}

std::vector<std::string> TcpTransport::descriptions() const {
  return {"tcp " + endpoint_text(local_endpoint())};
}

std::vector<Counter> TcpTransport::counts() const {
  return tcp_counters({impl_->connections, impl_->listener->refused(), impl_->bytes_in, impl_->bytes_out,
                       impl_->dropped, impl_->lost});
}

std::vector<Counter> tcp_counters(const TcpTransportCounts& counts) {
  using Fault = Counter::Fault;
  using Shown = Counter::Shown;
  return {{"connections", counts.connections, "connections of clients"},
          {"refused", counts.refused, "connections refused: not in `allow`, or too many", Fault::none,
           Shown::warns, "{} clients were refused: not in `allow`, or too many"},
          {"bytes_in", counts.bytes_in, "bytes from clients"},
          {"bytes_out", counts.bytes_out, "bytes to clients; to two clients, they count twice"},
          {"messages_dropped", counts.dropped, "messages dropped: the client reads too slowly", Fault::none,
           Shown::warns, "{} messages were dropped: the client reads too slowly"},
          {"messages_lost", counts.lost, "messages lost: the client was gone"}};
}

Endpoint TcpTransport::local_endpoint() const {
  return impl_->listener->local();
}

}  // namespace sonard::server
