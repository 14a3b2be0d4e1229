// SPDX-License-Identifier: Apache-2.0
#include "server/pose/tcp_pose_source.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <set>
#include <utility>

#include "server/net/addresses.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

Endpoint to_endpoint(const tcp::endpoint& endpoint) {
  return {endpoint.address().to_v4().to_uint(), endpoint.port()};
}

}  // namespace

struct TcpPoseSource::Impl : std::enable_shared_from_this<TcpPoseSource::Impl> {
  class Session;

  Impl(asio::io_context& io, TcpPoseInput configured, const Clock& used_clock, PoseSink poses_go_to,
       PoseHold publishers_wait, std::chrono::milliseconds timeout)
      : input(std::move(configured)),
        clock(used_clock),
        sink(std::move(poses_go_to)),
        hold(std::move(publishers_wait)),
        message_timeout(timeout),
        acceptor(io),
        retry(io) {}

  void open();
  void accept();
  void on_accepted(const error_code& error, tcp::socket socket);
  void admit(tcp::socket socket, const tcp::endpoint& peer);
  void refuse(const tcp::endpoint& peer, const char* reason);
  void stop();

  TcpPoseInput input;
  const Clock& clock;
  PoseSink sink;
  PoseHold hold;
  std::chrono::milliseconds message_timeout;
  tcp::acceptor acceptor;
  asio::steady_timer retry;
  Endpoint local;
  std::optional<Endpoint> publisher;  // of the newest pose
  std::set<std::shared_ptr<Session>> sessions;
  PoseSourceCounters counters;
  PeerLog log;
};

/// One publisher. The set of its source owns it, and so does each pending handler.
class TcpPoseSource::Impl::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(std::shared_ptr<Impl> source, tcp::socket socket, Endpoint peer)
      : source_(std::move(source)),
        socket_(std::move(socket)),
        timer_(socket_.get_executor()),
        hold_timer_(socket_.get_executor()),
        peer_(peer),
        buffer_(pose::max_frame_bytes) {}

  void read() {
    socket_.async_read_some(asio::buffer(buffer_.data() + filled_, buffer_.size() - filled_),
                            [self = this->shared_from_this()](const error_code& error, std::size_t length) {
                              self->on_read(error, length);
                            });
  }

  /// Ends the session; pending handlers find the socket closed.
  void close() {
    error_code ignored;
    socket_.close(ignored);
    timer_.cancel(ignored);
    hold_timer_.cancel(ignored);
    source_->sessions.erase(shared_from_this());
  }

 private:
  void on_read(const error_code& error, std::size_t length) {
    if (!socket_.is_open()) {
      return;
    }
    if (error) {
      source_->log.info("pose stream tcp {}: {} left", endpoint_text(source_->local), endpoint_text(peer_));
      close();
      return;
    }
    filled_ += length;
    const bool finished_a_message = take_frames(source_->clock.now());
    if (socket_.is_open()) {
      read_on(finished_a_message);
    }
  }

  /// Reads when publishers need not wait, which is asked now and then.
  void read_on(bool finished_a_message) {
    if (!source_->hold || !source_->hold()) {
      watch_unfinished_message(finished_a_message);
      read();
      return;
    }
    stop_watching();  // it is not for the publisher to finish its message now
    hold_timer_.expires_after(std::chrono::milliseconds{2});
    hold_timer_.async_wait([self = shared_from_this()](const error_code& error) {
      if (!error && self->socket_.is_open()) {
        self->read_on(false);
      }
    });
  }

  /// Delivers every whole message in the buffer and keeps the rest. @return true when there was one.
  bool take_frames(TimePoint arrival) {
    bool finished_a_message = false;
    std::span<const std::uint8_t> rest{buffer_.data(), filled_};
    while (socket_.is_open()) {
      const std::ptrdiff_t frame_bytes = pose::next_frame(rest);
      if (frame_bytes < 0) {
        ++source_->counters.malformed;
        close_faulty("a message length is none, or beyond 65507 bytes");
        break;
      }
      if (frame_bytes == 0) {
        break;
      }
      const auto frame = rest.first(static_cast<std::size_t>(frame_bytes));
      rest = rest.subspan(frame.size());
      finished_a_message = true;
      take_message(pose::frame_message(frame), arrival);
    }
    filled_ = rest.size();
    std::copy(rest.begin(), rest.end(), buffer_.begin());  // to the front, so overlap does no harm
    return finished_a_message;
  }

  void take_message(std::span<const std::uint8_t> message, TimePoint arrival) {
    const auto sample = pose::decode(message);
    if (sample) {
      ++source_->counters.samples;
      source_->publisher = peer_;
      source_->sink(*sample, arrival);
      return;
    }
    if (sample.error().kind == pose::PoseError::Kind::malformed) {
      ++source_->counters.malformed;
      close_faulty(to_string(sample.error()));
      return;
    }
    ++source_->counters.bad_value;
    if (std::has_single_bit(++bad_values_)) {
      spdlog::warn("pose stream tcp {}: message from {} dropped: {} ({} so far)",
                   endpoint_text(source_->local), endpoint_text(peer_), to_string(sample.error()),
                   bad_values_);
    }
  }

  /// Gives a message that has begun its deadline, which further bytes of it do not move.
  void watch_unfinished_message(bool finished_a_message) {
    if (filled_ == 0) {
      stop_watching();
      return;
    }
    if (unfinished_ && !finished_a_message) {
      return;
    }
    unfinished_ = true;
    timer_.expires_after(source_->message_timeout);
    timer_.async_wait([self = shared_from_this()](const error_code& error) {
      // A wait that had ended before the timer was set again comes here too; the expiry tells.
      const bool due = !error && self->timer_.expiry() <= std::chrono::steady_clock::now();
      if (due && self->unfinished_ && self->socket_.is_open()) {
        self->close_faulty("a message was left unfinished");
      }
    });
  }

  void stop_watching() {
    unfinished_ = false;
    error_code ignored;
    timer_.cancel(ignored);
  }

  void close_faulty(const std::string& reason) {
    ++source_->counters.closed;
    source_->log.warn("pose stream tcp {}: {} closed: {}", endpoint_text(source_->local),
                      endpoint_text(peer_), reason);
    close();
  }

  std::shared_ptr<Impl> source_;
  tcp::socket socket_;
  asio::steady_timer timer_;
  asio::steady_timer hold_timer_;
  Endpoint peer_;
  std::vector<std::uint8_t> buffer_;
  std::size_t filled_ = 0;
  bool unfinished_ = false;  // the timer runs for a message that has begun
  std::uint64_t bad_values_ = 0;
};

void TcpPoseSource::Impl::open() {
  error_code error;
  const auto check = [&](const char* operation) {
    if (error) {
      throw PoseSourceError(
          fmt::format("pose stream tcp {}: {}: {}", endpoint_text(input.bind), operation, error.message()));
    }
  };
  acceptor.open(tcp::v4(), error);
  check("open");
  // Connections of an earlier run that linger in TIME_WAIT must not block a restart. A live listener still
  // does.
  acceptor.set_option(tcp::acceptor::reuse_address{true}, error);
  check("set SO_REUSEADDR");
  acceptor.bind({asio::ip::address_v4{input.bind.address}, input.bind.port}, error);
  check("bind");
  acceptor.listen(tcp::acceptor::max_listen_connections, error);
  check("listen");
  const tcp::endpoint bound = acceptor.local_endpoint(error);
  check("local address");
  local = to_endpoint(bound);
}

void TcpPoseSource::Impl::accept() {
  acceptor.async_accept([self = shared_from_this()](const error_code& error, tcp::socket socket) {
    self->on_accepted(error, std::move(socket));
  });
}

void TcpPoseSource::Impl::on_accepted(const error_code& error, tcp::socket socket) {
  if (!acceptor.is_open()) {
    return;
  }
  if (!error) {
    error_code gone;
    const tcp::endpoint peer = socket.remote_endpoint(gone);
    if (!gone) {
      admit(std::move(socket), peer);
    }
    accept();
    return;
  }
  // Out of file descriptors, most likely: asking again at once would only spin.
  log.error("pose stream tcp {}: accept: {}", endpoint_text(local), error.message());
  retry.expires_after(std::chrono::seconds{1});
  retry.async_wait([self = shared_from_this()](const error_code& cancelled) {
    if (!cancelled && self->acceptor.is_open()) {
      self->accept();
    }
  });
}

void TcpPoseSource::Impl::admit(tcp::socket socket, const tcp::endpoint& peer) {
  if (!allows(input.allow, to_endpoint(peer).address)) {
    refuse(peer, "not in the allow list");
    return;
  }
  if (std::ssize(sessions) >= input.max_clients) {
    refuse(peer, "too many publishers");
    return;
  }
  // A publisher whose machine is gone without a word gives its place back in the end.
  error_code ignored;
  socket.set_option(tcp::socket::keep_alive{true}, ignored);
  ++counters.connections;
  log.info("pose stream tcp {}: {} connected", endpoint_text(local), endpoint_text(to_endpoint(peer)));
  const auto session = std::make_shared<Session>(shared_from_this(), std::move(socket), to_endpoint(peer));
  sessions.insert(session);
  session->read();
}

void TcpPoseSource::Impl::refuse(const tcp::endpoint& peer, const char* reason) {
  if (std::has_single_bit(++counters.refused)) {
    spdlog::warn("pose stream tcp {}: {} refused: {} ({} so far)", endpoint_text(local),
                 endpoint_text(to_endpoint(peer)), reason, counters.refused);
  }
}

void TcpPoseSource::Impl::stop() {
  error_code ignored;
  acceptor.close(ignored);
  retry.cancel(ignored);
  for (const auto& session : std::set{sessions}) {  // a copy: close() takes the session out of the set
    session->close();
  }
}

TcpPoseSource::TcpPoseSource(asio::io_context& io, TcpPoseInput input, const Clock& clock, PoseSink sink,
                             PoseHold hold, std::chrono::milliseconds message_timeout)
    : impl_(std::make_shared<Impl>(io, std::move(input), clock, std::move(sink), std::move(hold),
                                   message_timeout)) {}

TcpPoseSource::~TcpPoseSource() {
  impl_->stop();
}

void TcpPoseSource::start() {
  impl_->open();
  impl_->accept();
}

void TcpPoseSource::stop() {
  impl_->stop();
}

std::string TcpPoseSource::description() const {
  const bool started = impl_->local.port != 0;
  return "pose stream tcp " + endpoint_text(started ? impl_->local : impl_->input.bind);
}

const PoseSourceCounters& TcpPoseSource::counters() const {
  return impl_->counters;
}

std::string TcpPoseSource::received() const {
  return impl_->publisher ? "from " + endpoint_text(*impl_->publisher) : std::string();
}

Endpoint TcpPoseSource::local_endpoint() const {
  return impl_->local;
}

std::size_t TcpPoseSource::client_count() const {
  return impl_->sessions.size();
}

}  // namespace sonard::server
