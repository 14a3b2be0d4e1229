// SPDX-License-Identifier: Apache-2.0
#include "server/web/http_session.hpp"

#include <chrono>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "server/web/foxglove_session.hpp"
#include "server/web/live_session.hpp"

namespace sonard::server {

namespace beast = boost::beast;
namespace http = beast::http;

namespace {

constexpr std::uint32_t most_header_bytes = 8192;
constexpr std::uint64_t most_body_bytes = 4096;
constexpr std::size_t most_drained_bytes = 256 << 10;
constexpr std::chrono::seconds drain_patience{2};
constexpr std::chrono::seconds patience{30};  // to receive a request, and to send an answer

/// The first protocol that a client offers for a WebSocket and that a FoxgloveSession speaks; empty: none.
std::string_view foxglove_protocol(const HttpRequest& request) {
  for (const beast::string_view offered : http::token_list{request[http::field::sec_websocket_protocol]}) {
    for (const std::string_view known : FoxgloveSession::protocols) {
      if (offered == beast::string_view(known.data(), known.size())) {
        return known;
      }
    }
  }
  return {};
}

}  // namespace

HttpSession::HttpSession(Site& site, boost::asio::ip::tcp::socket socket, const Endpoint& peer)
    : site_(site), stream_(std::move(socket)), peer_(peer) {}

HttpSession::~HttpSession() {
  leave();
}

void HttpSession::start() {
  place_ = site_.connections().enter(peer_.address, [weak = weak_from_this()] {
    if (const auto self = weak.lock()) {
      self->displace();
    }
  });
  read();
}

/// Closes this connection, because another one gets its place.
void HttpSession::displace() {
  place_.reset();
  stream_.close();
  site_.log_refusal(peer_, "too many connections; the connection idle longest is closed");
}

void HttpSession::leave() {
  if (place_) {
    site_.connections().leave(*std::exchange(place_, std::nullopt));
  }
}

void HttpSession::read() {
  parser_.emplace();
  parser_->header_limit(most_header_bytes);
  parser_->body_limit(most_body_bytes);
  stream_.expires_after(patience);
  http::async_read(
      stream_, buffer_, *parser_,
      [self = shared_from_this()](beast::error_code error, std::size_t) { self->on_read(error); });
}

void HttpSession::on_read(beast::error_code error) {
  if (error) {
    refuse(error);
    return;
  }
  if (!place_) {
    return;  // displaced while this handler was queued
  }
  site_.connections().used(*place_);
  HttpRequest request = parser_->release();
  if (beast::websocket::is_upgrade(request) && !site_.refusal(request)) {
    if (const std::string_view protocol = foxglove_protocol(request); !protocol.empty()) {
      upgrade<FoxgloveSession>(std::move(request), protocol);
      return;
    }
    if (request.target() == "/api/live") {
      upgrade<LiveSession>(std::move(request), {});
      return;
    }
    send(error_response(
        request, http::status::bad_request,
        fmt::format("This is no WebSocket of sonard. Offer one of the protocols {}, or use the "
                    "path /api/live.",
                    fmt::join(FoxgloveSession::protocols, ", "))));
    return;
  }
  stream_.expires_never();  // the server, not the client, takes the time for the answer
  site_.answer(request, peer_,
               [self = shared_from_this()](HttpResponse response) { self->send(std::move(response)); });
}

/// Answers an invalid request. An incomplete request gets no answer.
void HttpSession::refuse(beast::error_code why) {
  const bool malformed = why.category() == http::make_error_code(http::error::bad_method).category();
  if (!malformed || why == http::error::end_of_stream || why == http::error::partial_message) {
    close();
    return;
  }
  refused_ = true;
  HttpRequest none;
  none.version(11);
  none.keep_alive(false);
  if (why == http::error::header_limit || why == http::error::buffer_overflow) {
    send(error_response(none, http::status::request_header_fields_too_large,
                        fmt::format("The header has more than {} bytes.", most_header_bytes)));
  } else if (why == http::error::body_limit) {
    send(error_response(none, http::status::payload_too_large,
                        fmt::format("The body has more than {} bytes.", most_body_bytes)));
  } else {
    send(error_response(none, http::status::bad_request,
                        fmt::format("Invalid HTTP request: {}.", why.message())));
  }
}

/// Reads and drops further bytes after a refused request for a while. Closing a connection with unread bytes
/// would reset it, and the answer could be lost.
void HttpSession::drain() {
  buffer_.clear();
  stream_.expires_after(drain_patience);
  stream_.async_read_some(buffer_.prepare(most_header_bytes),
                          [self = shared_from_this()](beast::error_code error, std::size_t length) {
                            self->drained_bytes_ += length;
                            if (!error && self->drained_bytes_ < most_drained_bytes) {
                              self->drain();
                            }
                          });
}

template <class Session>
void HttpSession::upgrade(HttpRequest request, std::string_view protocol) {
  if (const std::string why = site_.connections().add_viewer(peer_.address); !why.empty()) {
    site_.log_refusal(peer_, why);
    send(error_response(request, http::status::service_unavailable, why));
    return;
  }
  leave();
  stream_.expires_never();
  const auto session = std::make_shared<Session>(site_, std::move(stream_), peer_);
  site_.add(session);
  session->start(std::move(request), protocol);
}

void HttpSession::send(HttpResponse response) {
  const auto kept = std::make_shared<HttpResponse>(std::move(response));
  stream_.expires_after(patience);
  http::async_write(stream_, *kept, [self = shared_from_this(), kept](beast::error_code error, std::size_t) {
    if (error || kept->need_eof()) {
      self->close();
    } else {
      self->read();
    }
  });
}

void HttpSession::close() {
  beast::error_code ignored;
  stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
  if (refused_) {
    drain();
  }
}

}  // namespace sonard::server
