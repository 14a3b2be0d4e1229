// SPDX-License-Identifier: Apache-2.0
// A head on one UDP socket, with the faults that its link may have.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/clock/clock.hpp"
#include "server/net/addresses.hpp"
#include "server/net/faulty_link.hpp"
#include "server/net/transport.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

struct UdpTransportConfig {
  Endpoint bind;
  AllowList allow;  ///< whose datagrams are taken; what goes to everybody is not affected
  LinkConfig link;
};

/// Replies go to the Peer that a device names, from the address of ours that it names. Both directions pass a
/// FaultyLink, also on loopback, before they are recorded (to clients) or after (from clients).
class UdpTransport final : public Transport {
 public:
  /// @throws SocketError
  UdpTransport(boost::asio::io_context& io, const Clock& clock, const UdpTransportConfig& config);
  ~UdpTransport() override;

  void start(TransportEvents events) override;
  void stop() override;
  void send(std::vector<Outgoing> messages) override;
  bool blocked() const override;
  std::vector<std::string> descriptions() const override;
  std::string faults() const override;
  std::vector<Counter> counts() const override;

  /// Where messages to everybody go, and the address of ours that they come from; 0: the kernel chooses.
  void set_everybody(std::vector<Endpoint> hosts, Ipv4 from);
  /// The address that a recording shows for a socket that is bound to all of them.
  void set_own_address(Ipv4 address);
  /// Moves the socket. @throws SocketError, and stays where it is
  void rebind(const Endpoint& bind);
  Endpoint local_endpoint() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
