// SPDX-License-Identifier: Apache-2.0
// A head that is reached through several transports at once.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "server/net/transport.hpp"

namespace sonard::server {

/// Channel i of the device (Peer::channel) is the i-th transport. Messages to everybody go out on all of
/// them.
class SeveralTransports final : public Transport {
 public:
  explicit SeveralTransports(std::vector<std::unique_ptr<Transport>> transports)
      : transports_(std::move(transports)) {}

  void start(TransportEvents events) override;
  void stop() override;
  void send(std::vector<Outgoing> messages) override;
  void disconnect(const Peer& client) override;
  bool blocked() const override;
  std::vector<std::string> descriptions() const override;
  std::string faults() const override;
  /// Sums of equal counters over the channels.
  std::vector<Counter> counts() const override;

 private:
  std::vector<std::unique_ptr<Transport>> transports_;
};

}  // namespace sonard::server
