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
  AllowList allow;  ///< permitted clients
  /// A client that has not taken a message for this long is closed at the next message to it, too; zero:
  /// never.
  std::chrono::nanoseconds stall_limit{};
};

/// Counts of a TcpTransport; they only grow.
struct TcpTransportCounts {
  std::uint64_t connections = 0;
  std::uint64_t refused = 0;
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
  std::uint64_t dropped = 0;  ///< messages: the client reads too slowly
  std::uint64_t lost = 0;     ///< messages: the client was gone
};
std::vector<Counter> tcp_counters(const TcpTransportCounts& counts);

/// Each client is a separate stream, from ClientCame to ClientGone. A client that ends its sending direction
/// has left. Messages go to the Peer that they name. Messages to everybody are broadcasts and are not sent on
/// streams.
///
/// A client that reads too slowly misses whole messages: while a message is being sent, only short ones are
/// queued, and others are dropped. A started message is always sent completely. When a new client connects,
/// clients that have not taken a message for most_stall are closed, because a device that serves one client
/// at a time would otherwise be blocked.
class TcpTransport final : public Transport {
 public:
  /// Further clients are closed at once and counted as refused.
  static constexpr std::size_t most_clients = 16;
  /// Limit of short messages, and of their queued bytes.
  static constexpr std::size_t short_message_bytes = 4096;
  static constexpr std::size_t most_waiting_bytes = 65536;
  static constexpr std::chrono::seconds most_stall{30};

  /// @param clock must outlive this object
  /// @throws SocketError
  TcpTransport(boost::asio::io_context& io, const TcpTransportConfig& config, const Clock& clock);
  ~TcpTransport() override;

  void start(TransportEvents events) override;
  void stop() override;
  void send(std::vector<Outgoing> messages) override;
  void disconnect(const Peer& client) override;
  std::vector<std::string> descriptions() const override;
  std::vector<Counter> counts() const override;

  /// Moves the listener; disconnects clients. @throws SocketError, and keeps the old address
  void rebind(const Endpoint& bind);
  Endpoint local_endpoint() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
