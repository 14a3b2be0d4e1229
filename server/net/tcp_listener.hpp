// SPDX-License-Identifier: Apache-2.0
// A TCP port that accepts allowed clients.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/net/addresses.hpp"
#include "server/program_log/peer_log.hpp"
#include "server/program_log/reasons.hpp"

namespace sonard::server {

/// A client whose machine or network has vanished is closed: a silent one within a minute, one with
/// unacknowledged data within half a minute.
///
/// Belongs to the I/O thread. Shared with its queued handlers, which find it closed after close().
class TcpListener : public std::enable_shared_from_this<TcpListener> {
 public:
  /// Receives an allowed client; its socket closes if it is not kept.
  using Accepted = std::function<void(boost::asio::ip::tcp::socket socket, const Endpoint& peer)>;

  /// `name` begins each log line: "pose stream tcp".
  TcpListener(boost::asio::io_context& io, std::string name, const Endpoint& bind, AllowList allow)
      : name_(std::move(name)), local_(bind), allow_(std::move(allow)), acceptor_(io), retry_(io) {}

  /// @throws SocketError
  void open();
  void start(Accepted accepted);
  void close();

  /// Counts a client whose socket is not kept; for each reason, the 1st, 2nd, 4th, ... is logged.
  void refuse(const Endpoint& peer, const char* reason);
  std::uint64_t refused() const { return refused_; }
  /// The listening address; before open(), the configured one.
  const Endpoint& local() const { return local_; }
  /// "pose stream tcp 127.0.0.1:14601"
  std::string description() const { return name_ + " " + endpoint_text(local_); }

 private:
  void accept();
  void on_accepted(const boost::system::error_code& error, boost::asio::ip::tcp::socket socket);

  std::string name_;
  Endpoint local_;
  AllowList allow_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer retry_;
  Accepted accepted_;
  std::uint64_t refused_ = 0;
  Reasons refusals_;
  PeerLog log_;
};

}  // namespace sonard::server
