// SPDX-License-Identifier: Apache-2.0
// A head on one UDP socket, with the configured faults of its link.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/clock/clock.hpp"
#include "server/net/addresses.hpp"
#include "server/net/faulty_link.hpp"
#include "server/net/transport.hpp"
#include "server/net/udp_endpoint.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

struct UdpTransportConfig {
  Endpoint bind;
  AllowList allow;  ///< permitted clients; does not affect messages to everybody
  LinkConfig link;
  int multicast_ttl = 0;  ///< UdpEndpoint::set_multicast_ttl(); 0: the head sends no multicast
};

/// Replies go to the Peer that a device names, from our address that it names. Both directions pass a
/// FaultyLink, also on loopback. Datagrams to clients are recorded after it, datagrams from clients before
/// it.
std::vector<Counter> udp_counters(const UdpEndpointCounters& socket, std::uint64_t not_allowed);
/// Counters of one direction of a link with faults.
std::vector<Counter> link_counters(const FaultyLinkCounters& link, bool to_client);

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

  /// Destinations of messages to everybody, and their source address; 0: the kernel chooses.
  void set_everybody(std::vector<Endpoint> hosts, Ipv4 from);
  /// Our address in a recording if the socket is bound to all addresses.
  void set_own_address(Ipv4 address);
  /// Moves the socket. @throws SocketError, and keeps the old address
  void rebind(const Endpoint& bind);
  Endpoint local_endpoint() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
