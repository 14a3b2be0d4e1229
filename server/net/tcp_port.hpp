// SPDX-License-Identifier: Apache-2.0
// A serial line as raw bytes over TCP, the way serial device servers give it.
#pragma once

#include <chrono>
#include <memory>

#include "server/clock/clock.hpp"
#include "server/net/serial_port.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// Bytes pass both ways unchanged; there are no RFC 2217 or telnet escapes.
/// Segments mean nothing: a command may come in any pieces. A client that ends its sending direction has
/// left. One that vanished without a word gives its place back (TcpListener). One that says nothing stays,
/// for it may only listen, until there are most_clients: then the next takes the place of the one that is
/// silent longest, and for most_silence at least.
///
/// Shutdown: stop() closes acceptor and connections. Handlers that are still queued find them closed; they
/// share ownership of the inner state, so the port may be destroyed before they run.
class TcpPort final : public SerialPort {
 public:
  /// Further clients are closed at once, and counted as refused.
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
