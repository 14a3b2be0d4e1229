// SPDX-License-Identifier: Apache-2.0
// A WebSocket of the page's server, for any content.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "server/web/site.hpp"

namespace sonard::server {

/// Belongs to the page's thread. Lives while one of its operations is in progress; `site` outlives it.
class WebSocket : public Viewer, public std::enable_shared_from_this<WebSocket> {
 public:
  ~WebSocket() override;

  /// Accepts the request for a WebSocket.
  /// @param protocol Sec-WebSocket-Protocol of the answer, a literal; empty: none
  void start(HttpRequest request, std::string_view protocol);
  std::optional<TimePoint> waits_since() const override { return waits_since_; }
  void close() override;

 protected:
  struct Message {
    std::string head;  ///< for this connection only
    Text bytes;        ///< shared with other connections
    bool binary = false;
  };

  /// The site's Connections must have a place for it.
  /// @param most_bytes limit of a message from the other side; a longer one ends the connection
  WebSocket(Site& site, boost::beast::tcp_stream stream, const Endpoint& peer, std::size_t most_bytes);

  /// Called when the connection is established.
  virtual void opened() {}
  /// Called for each received message.
  virtual void take(const std::string& text) = 0;

  /// True if there is room for a message: a slow reader gets no more messages.
  bool has_room() const { return !closed_ && queue_.size() + promised_ < most_queued; }
  /// Drops the message if there is no room.
  void send(Message message);
  void send_text(std::string text) {
    send({"", std::make_shared<const std::string>(std::move(text)), false});
  }
  /// Reserves room for a message that is still being made.
  void promise() { ++promised_; }
  /// Sends a promised message; drops it if it has no bytes.
  void send_promised(Message message);
  boost::beast::tcp_stream::executor_type executor() { return socket_.get_executor(); }
  Site& site() { return site_; }
  const Site& site() const { return site_; }
  template <class Session>
  std::weak_ptr<Session> weak() {
    return std::static_pointer_cast<Session>(shared_from_this());
  }

 private:
  static constexpr std::size_t most_queued = 4;

  void read();
  void queue(Message message);
  void write();
  void drop_last();

  Site& site_;
  const Endpoint peer_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  boost::beast::flat_buffer buffer_;
  std::deque<Message> queue_;  ///< the first is being written
  std::size_t promised_ = 0;
  std::optional<TimePoint> waits_since_;  ///< for the first of queue_
  boost::asio::steady_timer patience_;    ///< for the first of queue_
  bool closed_ = false;
};

}  // namespace sonard::server
