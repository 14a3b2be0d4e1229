// SPDX-License-Identifier: Apache-2.0
// A serial line in datagrams.
#pragma once

#include <memory>
#include <string>

#include "server/net/serial_port.hpp"
#include "server/net/udp_endpoint.hpp"

namespace sonard::server {

/// Sends each frame as one datagram to the peer that sent last, from the address to which that peer sent. A
/// peer has left when another sends. UDP reports no other departure: the last peer counts as connected for
/// ever.
class UdpPort final : public SerialPort {
 public:
  /// @throws SocketError
  UdpPort(boost::asio::io_context& io, const SerialUdpConfig& config);
  ~UdpPort() override;

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
