// SPDX-License-Identifier: Apache-2.0
// A WebSocket of the page's server, whatever it carries.
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

/// Belongs to the thread of the page. It lives as long as one of its operations is under way; `site` outlives
/// it.
class WebSocket : public Viewer, public std::enable_shared_from_this<WebSocket> {
 public:
  ~WebSocket() override;

  /// Answers the request that asks for a WebSocket.
  void start(HttpRequest request);
  std::optional<TimePoint> waits_since() const override { return waits_since_; }
  void close() override;

 protected:
  struct Message {
    std::string head;  ///< of this connection alone
    Text bytes;        ///< shared with others
    bool binary = false;
  };

  /// @param protocol Sec-WebSocket-Protocol of the answer; empty: none
  /// @param most_bytes of a message from the other side; a longer one ends the connection
  /// The site's Connections have a place for it.
  WebSocket(Site& site, boost::beast::tcp_stream stream, const Endpoint& peer, std::string protocol,
            std::size_t most_bytes);

  /// The connection stands.
  virtual void opened() {}
  /// A message has come.
  virtual void take(const std::string& text) = 0;

  /// Whether there is room for a message: one who reads too slowly gets nothing more.
  bool has_room() const { return !closed_ && queue_.size() + promised_ < most_queued; }
  /// Drops it where there is no room.
  void send(Message message);
  void send_text(std::string text) {
    send({"", std::make_shared<const std::string>(std::move(text)), false});
  }
  /// Keeps room for a message that is not made yet.
  void promise() { ++promised_; }
  /// Sends a message that was promised; without bytes it is dropped.
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
  std::optional<TimePoint> waits_since_;  ///< the first of queue_
  boost::asio::steady_timer patience_;    ///< with the first of queue_
  bool closed_ = false;
};

}  // namespace sonard::server
