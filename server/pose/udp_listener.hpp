// SPDX-License-Identifier: Apache-2.0
// A UDP socket that receives from permitted publishers.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "server/clock/clock.hpp"
#include "server/net/addresses.hpp"
#include "server/net/udp_endpoint.hpp"

namespace sonard::server {

/// Belongs to the I/O thread.
class UdpListener {
 public:
  /// `bytes` and the peer of this datagram are valid during the call, which may close the listener.
  using Handler = std::function<void(std::span<const std::uint8_t> bytes, TimePoint arrival)>;

  /// `name` begins each log line: "pose stream udp". `clock` outlives this object.
  UdpListener(boost::asio::io_context& io, std::string name, const Endpoint& bind, AllowList allow,
              const Clock& clock);

  /// Binds and listens. Called once.
  /// @throws Error
  void start(Handler handler);
  /// Closes the socket; the handler is not called any more.
  void close();
  bool is_open() const { return open_; }

  /// The listening address, before and after start().
  const Endpoint& local() const { return local_; }
  /// Sender of the current or the last datagram.
  const Endpoint& peer() const { return peer_; }
  /// "pose stream udp 127.0.0.1:14600"
  std::string description() const;
  /// Number of datagrams from peers that are not allowed; the 1st, 2nd, 4th ... is logged.
  std::uint64_t refused() const { return refused_; }

 private:
  void take(const Datagram& datagram, const Handler& handler);

  boost::asio::io_context& io_;
  std::string name_;
  Endpoint local_;
  AllowList allow_;
  const Clock& clock_;
  std::optional<UdpEndpoint> socket_;
  bool open_ = false;
  Endpoint peer_;
  std::uint64_t refused_ = 0;
};

}  // namespace sonard::server
