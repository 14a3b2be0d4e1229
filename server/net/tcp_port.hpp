// SPDX-License-Identifier: Apache-2.0
// A serial line as raw bytes over TCP, like serial device servers.
#pragma once

#include <chrono>
#include <memory>

#include "server/clock/clock.hpp"
#include "server/net/serial_port.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// Bytes pass unchanged in both directions; there are no RFC 2217 or telnet escapes. Segments have no
/// meaning: a command may come in any pieces. A client that ends its sending direction has left. A vanished
/// client is closed (TcpListener). A silent client stays, because it may only listen. If there are
/// most_clients, the next client replaces the one that has been silent longest, if that is at least
/// most_silence.
///
/// Shutdown: stop() closes acceptor and connections. Queued handlers find them closed; they share ownership
/// of the inner state, so the port may be destroyed before they run.
class TcpPort final : public SerialPort {
 public:
  /// Further clients replace a silent client, or are closed at once and counted as refused.
  static constexpr std::size_t most_clients = 16;
  static constexpr std::chrono::seconds most_silence{30};

  /// @throws SocketError
  TcpPort(boost::asio::io_context& io, const SerialTcpConfig& config, const Clock& clock);
  ~TcpPort() override;

  void start(SerialPortEvents events) override;
  void stop() override;
  void send(std::span<const std::uint8_t> frame) override;
  bool connected() const override;
  std::string description() const override;
  SerialPortCounters counters() const override;

  Endpoint local_endpoint() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
