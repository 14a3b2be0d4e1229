// SPDX-License-Identifier: Apache-2.0
#include "server/pose/tcp/source.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <set>
#include <utility>

#include "server/error/error.hpp"
#include "server/net/tcp_listener.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/pose/unreadable_messages.hpp"
#include "server/program_log/peer_log.hpp"
#include "server/program_log/reasons.hpp"

namespace sonard::server {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

struct TcpPoseSource::Impl : std::enable_shared_from_this<TcpPoseSource::Impl> {
  class Session;

  Impl(asio::io_context& io, const TcpPoseInput& input, const Clock& used_clock, PoseSink poses_go_to,
       PoseHold publishers_wait, std::chrono::milliseconds timeout)
      : listener(std::make_shared<TcpListener>(io, "pose stream tcp", input.bind, input.allow)),
        max_clients(input.max_clients),
        clock(used_clock),
        sink(std::move(poses_go_to)),
        hold(std::move(publishers_wait)),
        message_timeout(timeout) {}

  void admit(tcp::socket socket, const Endpoint& peer);
  bool make_room();
  void stop();

  std::shared_ptr<TcpListener> listener;
  int max_clients;
  const Clock& clock;
  PoseSink sink;
  PoseHold hold;
  std::chrono::milliseconds message_timeout;
  std::optional<PublisherId> publisher;  // of the newest pose
  std::set<std::shared_ptr<Session>> sessions;
  PoseSourceCounters counters;
  UnreadableMessages unreadable;
  PeerLog log;
};

/// A connected publisher. The source's set and each pending handler own it.
class TcpPoseSource::Impl::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(std::shared_ptr<Impl> source, tcp::socket socket, Endpoint peer)
      : source_(std::move(source)),
        socket_(std::move(socket)),
        timer_(socket_.get_executor()),
        hold_timer_(socket_.get_executor()),
        peer_(peer),
        newest_message_(source_->clock.now()),
        buffer_(pose::max_frame_bytes) {}

  void read() {
    socket_.async_read_some(asio::buffer(buffer_.data() + filled_, buffer_.size() - filled_),
                            [self = this->shared_from_this()](const error_code& error, std::size_t length) {
                              self->on_read(error, length);
                            });
  }

  TimePoint newest_message() const { return newest_message_; }

  void give_place() { close_faulty("it was silent, and another publisher needs its place"); }

  /// Ends the session; pending handlers find the socket closed.
  void close() {
    error_code ignored;
    socket_.close(ignored);
    timer_.cancel();
    hold_timer_.cancel();
    source_->sessions.erase(shared_from_this());
  }

 private:
  void on_read(const error_code& error, std::size_t length) {
    if (!socket_.is_open()) {
      return;
    }
    if (error) {
      source_->log.info("{}: {} disconnected", source_->listener->description(), endpoint_text(peer_));
      close();
      return;
    }
    filled_ += length;
    const bool finished_a_message = take_frames(source_->clock.now());
    if (socket_.is_open()) {
      read_on(finished_a_message);
    }
  }

  /// Reads, or, while publishers must wait, tries again every 2 ms.
  void read_on(bool finished_a_message) {
    if (!source_->hold || !source_->hold()) {
      watch_unfinished_message(finished_a_message);
      read();
      return;
    }
    stop_watching();  // the publisher cannot finish its message now
    hold_timer_.expires_after(std::chrono::milliseconds{2});
    hold_timer_.async_wait([self = shared_from_this()](const error_code& error) {
      if (!error && self->socket_.is_open()) {
        self->read_on(false);
      }
    });
  }

  /// Delivers every whole message in the buffer and keeps the rest. @return true if there was one
  bool take_frames(TimePoint arrival) {
    bool finished_a_message = false;
    std::span<const std::uint8_t> rest{buffer_.data(), filled_};
    while (socket_.is_open()) {
      const std::ptrdiff_t frame_bytes = pose::next_frame(rest);
      if (frame_bytes < 0) {
        ++source_->counters.malformed;
        close_unreadable("a message length is invalid, or above 65507 bytes", rest);
        break;
      }
      if (frame_bytes == 0) {
        break;
      }
      const auto frame = rest.first(static_cast<std::size_t>(frame_bytes));
      rest = rest.subspan(frame.size());
      finished_a_message = true;
      take_message(frame, arrival);
    }
    filled_ = rest.size();
    std::copy(rest.begin(), rest.end(), buffer_.begin());  // copies to the front, so overlap is safe
    return finished_a_message;
  }

  void take_message(std::span<const std::uint8_t> frame, TimePoint arrival) {
    const auto sample = pose::decode(pose::frame_message(frame));
    if (sample) {
      newest_message_ = arrival;
      ++source_->counters.samples;
      source_->publisher = {peer_};
      source_->sink(*sample, arrival);
      return;
    }
    if (sample.error().kind == pose::PoseError::Kind::malformed) {
      ++source_->counters.malformed;
      close_unreadable(to_string(sample.error()), frame);
      return;
    }
    ++source_->counters.bad_value;
    const std::string problem = to_string(sample.error());
    source_->unreadable.note(arrival, endpoint_text(peer_), problem);
    if (const std::uint64_t count = complaints_.count(problem); std::has_single_bit(count)) {
      spdlog::warn("{}: message from {} dropped: {} ({} so far)", source_->listener->description(),
                   endpoint_text(peer_), problem, count);
    }
  }

  /// Starts the deadline of a partial message; further bytes do not extend it.
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
      // A wait that had expired before the timer was set again also comes here; the expiry shows it.
      const bool due = !error && self->timer_.expiry() <= std::chrono::steady_clock::now();
      if (due && self->unfinished_ && self->socket_.is_open()) {
        self->close_unreadable("a message is incomplete", {self->buffer_.data(), self->filled_});
      }
    });
  }

  void stop_watching() {
    unfinished_ = false;
    timer_.cancel();
  }

  /// @param bytes of the message, from its length on
  void close_unreadable(const std::string& reason, std::span<const std::uint8_t> bytes) {
    const std::string problem = reason + mavlink_hint(bytes);
    source_->unreadable.note(source_->clock.now(), endpoint_text(peer_), problem);
    close_faulty(problem);
  }

  void close_faulty(const std::string& reason) {
    ++source_->counters.closed;
    source_->log.warn("{}: {} closed: {}", source_->listener->description(), endpoint_text(peer_), reason);
    close();
  }

  std::shared_ptr<Impl> source_;
  tcp::socket socket_;
  asio::steady_timer timer_;
  asio::steady_timer hold_timer_;
  Endpoint peer_;
  TimePoint newest_message_;  // arrival of the newest message, if any
  std::vector<std::uint8_t> buffer_;
  std::size_t filled_ = 0;
  bool unfinished_ = false;  // the timer runs for a partial message
  Reasons complaints_;
};

/// While `hold` makes publishers wait, no publisher counts as silent.
bool TcpPoseSource::Impl::make_room() {
  if (std::ssize(sessions) < max_clients) {
    return true;
  }
  const auto silent = *std::ranges::min_element(sessions, {}, &Session::newest_message);
  if (clock.now() - silent->newest_message() < most_silence || (hold && hold())) {
    return false;
  }
  silent->give_place();
  return true;
}

void TcpPoseSource::Impl::admit(tcp::socket socket, const Endpoint& peer) {
  if (!make_room()) {
    listener->refuse(peer, "too many publishers");
    return;
  }
  ++counters.connections;
  log.info("{}: {} connected", listener->description(), endpoint_text(peer));
  const auto session = std::make_shared<Session>(shared_from_this(), std::move(socket), peer);
  sessions.insert(session);
  session->read();
}

void TcpPoseSource::Impl::stop() {
  listener->close();
  for (const auto& session : std::set{sessions}) {  // a copy: close() removes the session from the set
    session->close();
  }
}

TcpPoseSource::TcpPoseSource(asio::io_context& io, const TcpPoseInput& input, const Clock& clock,
                             PoseSink sink, PoseHold hold, std::chrono::milliseconds message_timeout)
    : impl_(std::make_shared<Impl>(io, input, clock, std::move(sink), std::move(hold), message_timeout)) {}

TcpPoseSource::~TcpPoseSource() {
  impl_->stop();
}

void TcpPoseSource::start() {
  try {
    impl_->listener->open();
  } catch (const SocketError& error) {
    throw Error(ErrorKind::network, std::string("pose stream tcp: ") + error.what(), "poses");
  }
  impl_->listener->start([weak = impl_->weak_from_this()](tcp::socket socket, const Endpoint& peer) {
    if (const auto self = weak.lock()) {
      self->admit(std::move(socket), peer);
    }
  });
}

void TcpPoseSource::stop() {
  impl_->stop();
}

std::string TcpPoseSource::description() const {
  return impl_->listener->description();
}

const PoseSourceCounters& TcpPoseSource::counters() const {
  impl_->counters.refused = impl_->listener->refused();
  return impl_->counters;
}

std::optional<PublisherId> TcpPoseSource::publisher() const {
  return impl_->publisher;
}

std::string TcpPoseSource::unreadable(TimePoint now) const {
  return impl_->unreadable.text(now);
}

Endpoint TcpPoseSource::local_endpoint() const {
  return impl_->listener->local();
}

std::size_t TcpPoseSource::client_count() const {
  return impl_->sessions.size();
}

}  // namespace sonard::server
