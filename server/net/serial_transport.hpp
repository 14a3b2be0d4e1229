// SPDX-License-Identifier: Apache-2.0
// A head on a serial line that all its clients share.
#pragma once

#include "server/net/serial_link.hpp"
#include "server/net/transport.hpp"

namespace sonard::server {

/// Every message goes to all connected clients, whatever Peer it names.
std::vector<Counter> serial_counters(const SerialLinkCounters& link);

class SerialTransport final : public Transport {
 public:
  /// @throws SocketError
  SerialTransport(boost::asio::io_context& io, const Clock& clock, const SerialLinkConfig& config)
      : link_(io, config, clock) {}

  void start(TransportEvents events) override;
  void stop() override { link_.stop(); }
  void send(std::vector<Outgoing> messages) override;
  std::vector<std::string> descriptions() const override { return link_.descriptions(); }
  std::vector<Counter> counts() const override;

  SerialAddresses addresses() const { return link_.addresses(); }

 private:
  SerialLink link_;
};

}  // namespace sonard::server
