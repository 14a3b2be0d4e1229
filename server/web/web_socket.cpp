// SPDX-License-Identifier: Apache-2.0
#include "server/web/web_socket.hpp"

#include <chrono>
#include <utility>

#include <boost/beast/core/buffers_to_string.hpp>

namespace sonard::server {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

WebSocket::WebSocket(Site& site, beast::tcp_stream stream, std::string protocol, std::size_t most_bytes)
    : site_(site), socket_(std::move(stream)) {
  // One that is gone without a word is noticed by its silence to our pings.
  socket_.set_option(
      websocket::stream_base::timeout{std::chrono::seconds{10}, std::chrono::seconds{20}, true});
  if (!protocol.empty()) {
    socket_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
      response.set(beast::http::field::sec_websocket_protocol, protocol);
    }));
  }
  socket_.read_message_max(most_bytes);
}

WebSocket::~WebSocket() {
  site_.close_connection();
}

void WebSocket::start(HttpRequest request) {
  const auto kept = std::make_shared<HttpRequest>(std::move(request));
  socket_.async_accept(*kept, [self = shared_from_this(), kept](beast::error_code error) {
    if (!error) {
      self->opened();
      self->read();
    }
  });
}

void WebSocket::close() {
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
  if (!has_room()) {
    return;
  }
  queue_.push_back(std::move(message));
  if (queue_.size() == 1) {
    write();
  }
}

void WebSocket::write() {
  const Message& message = queue_.front();
  socket_.binary(message.binary);
  socket_.async_write(boost::asio::buffer(*message.bytes),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        self->queue_.pop_front();
                        if (error) {
                          self->close();
                        } else if (!self->queue_.empty()) {
                          self->write();
                        }
                      });
}

}  // namespace sonard::server
