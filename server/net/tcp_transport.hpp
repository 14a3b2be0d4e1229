// SPDX-License-Identifier: Apache-2.0
// A head that is a TCP server and sends messages of any length.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/clock/clock.hpp"
#include "server/net/addresses.hpp"
#include "server/net/transport.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

struct TcpTransportConfig {
  Endpoint bind;
  AllowList allow;  ///< who may connect
};

/// Each client is a stream of its own, from ClientCame to ClientGone; a client that ends its sending
/// direction has left. Messages go to the Peer that they name. What goes to everybody is a broadcast, and not
/// for streams.
///
/// A client that reads too slowly misses whole messages: while one waits for it, only short ones wait behind
/// that, and the others are dropped. A message that has begun is always sent to its end. A client that did
/// not take a message for most_stall is closed when another one comes: a device that serves one client at a
/// time would be lost to it.
class TcpTransport final : public Transport {
 public:
  /// Further clients are closed at once, and counted as refused.
  static constexpr std::size_t most_clients = 16;
  /// Short messages, and how many bytes of them may wait.
  static constexpr std::size_t short_message_bytes = 4096;
  static constexpr std::size_t most_waiting_bytes = 65536;
  static constexpr std::chrono::seconds most_stall{30};

  /// @param clock outlives this
  /// @throws SocketError
  TcpTransport(boost::asio::io_context& io, const TcpTransportConfig& config, const Clock& clock);
  ~TcpTransport() override;

  void start(TransportEvents events) override;
  void stop() override;
  void send(std::vector<Outgoing> messages) override;
  void disconnect(const Peer& client) override;
  std::vector<std::string> descriptions() const override;
  std::vector<Counter> counts() const override;

  /// Moves the listener; clients are disconnected. @throws SocketError, and stays where it is
  void rebind(const Endpoint& bind);
  Endpoint local_endpoint() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
