// SPDX-License-Identifier: Apache-2.0
#include "server/web/web_socket.hpp"

#include <array>
#include <chrono>
#include <utility>

#include <boost/beast/core/buffers_to_string.hpp>

namespace sonard::server {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {

constexpr std::chrono::seconds write_patience{30};  // for one message

}  // namespace

WebSocket::WebSocket(Site& site, beast::tcp_stream stream, const Endpoint& peer, std::size_t most_bytes)
    : site_(site), peer_(peer), socket_(std::move(stream)), patience_(socket_.get_executor()) {
  socket_.auto_fragment(false);  // fewer system calls than one for each 4 KiB
  // Detects a vanished peer: it does not answer WebSocket pings.
  socket_.set_option(
      websocket::stream_base::timeout{std::chrono::seconds{10}, std::chrono::seconds{20}, true});
  socket_.read_message_max(most_bytes);
}

WebSocket::~WebSocket() {
  while (!queue_.empty()) {
    drop_last();
  }
  site_.connections().remove_viewer(peer_.address);
}

void WebSocket::start(HttpRequest request, std::string_view protocol) {
  if (!protocol.empty()) {
    socket_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
      response.set(beast::http::field::sec_websocket_protocol,
                   beast::string_view(protocol.data(), protocol.size()));
    }));
  }
  const auto kept = std::make_shared<HttpRequest>(std::move(request));
  socket_.async_accept(*kept, [self = shared_from_this(), kept](beast::error_code error) {
    if (!error) {
      self->opened();
      self->read();
    }
  });
}

void WebSocket::close() {
  closed_ = true;
  patience_.cancel();
  while (queue_.size() > 1) {
    drop_last();
  }
  beast::error_code ignored;
  socket_.next_layer().socket().close(ignored);
}

void WebSocket::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (error) {
      self->close();
      return;
    }
    const std::string text = beast::buffers_to_string(self->buffer_.data());
    self->buffer_.consume(self->buffer_.size());
    self->take(text);
    self->read();
  });
}

void WebSocket::send(Message message) {
  if (has_room()) {
    queue(std::move(message));
  }
}

void WebSocket::send_promised(Message message) {
  --promised_;
  if (message.bytes && !closed_) {
    queue(std::move(message));
  }
}

void WebSocket::queue(Message message) {
  const std::size_t bytes = message.bytes->size();
  queue_.push_back(std::move(message));
  if (queue_.size() == 1) {
    write();
  }
  site_.count_waiting(static_cast<std::ptrdiff_t>(bytes));
}

void WebSocket::drop_last() {
  site_.count_waiting(-static_cast<std::ptrdiff_t>(queue_.back().bytes->size()));
  queue_.pop_back();
}

void WebSocket::write() {
  waits_since_ = site_.now();
  patience_.expires_after(write_patience);
  patience_.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
    const auto self = weak.lock();
    if (self && !error && self->waits_since_ && self->site_.now() - *self->waits_since_ >= write_patience) {
      self->site_.log_refusal(self->peer_, "the viewer reads too slowly");
      self->close();
    }
  });
  const Message& message = queue_.front();
  socket_.binary(message.binary);
  const std::array buffers{boost::asio::buffer(message.head), boost::asio::buffer(*message.bytes)};
  socket_.async_write(buffers, [self = shared_from_this()](beast::error_code error, std::size_t) {
    self->patience_.cancel();
    self->waits_since_.reset();
    self->site_.count_waiting(-static_cast<std::ptrdiff_t>(self->queue_.front().bytes->size()));
    self->queue_.pop_front();
    if (error) {
      self->close();
    } else if (!self->queue_.empty()) {
      self->write();
    }
  });
}

}  // namespace sonard::server
