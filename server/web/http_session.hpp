// SPDX-License-Identifier: Apache-2.0
// An HTTP connection: serves requests one after the other, until it becomes a WebSocket.
#pragma once

#include <memory>
#include <optional>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>

#include "server/web/site.hpp"

namespace sonard::server {

/// Belongs to the page's thread. Lives while one of its operations is in progress; `site` outlives it.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(Site& site, boost::asio::ip::tcp::socket socket, const Endpoint& peer);
  ~HttpSession();
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;

  void start();

 private:
  using Parser = boost::beast::http::request_parser<boost::beast::http::string_body>;

  void read();
  void on_read(boost::beast::error_code error);
  template <class Session>
  void upgrade(HttpRequest request, std::string_view protocol);
  void send(HttpResponse response);
  void refuse(boost::beast::error_code why);
  void drain();
  void close();
  void displace();
  void leave();

  Site& site_;
  boost::beast::tcp_stream stream_;
  Endpoint peer_;
  std::optional<Connections::Place> place_;
  bool refused_ = false;
  std::size_t drained_bytes_ = 0;
  boost::beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
};

}  // namespace sonard::server
