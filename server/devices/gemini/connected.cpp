// SPDX-License-Identifier: Apache-2.0
#include "server/devices/gemini/connected.hpp"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "protocol/gemini/device.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/net/interfaces.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/net/udp_transport.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {
namespace {

class ConnectedGemini final : public ConnectedDevice {
 public:
  ConnectedGemini(const HeadConfig& head, boost::asio::io_context& io, const Clock& clock)
      : name_(head.name),
        config_(device_settings<GeminiConfig>(head)),
        device_(config_.device, clock.now()),
        transport_(io, clock, {{config_.bind_address, config_.command_port}, config_.allow, config_.link}),
        addresses_(device_.addresses()),
        followed_(addresses_.alternate) {
    if (config_.trigger) {
      trigger_ = std::make_unique<UdpEndpoint>(io, *config_.trigger);
    }
    announce();
  }

  Device& device() override { return device_; }
  Transport& transport() override { return transport_; }

  void start(std::function<void(Event)> happen) override {
    if (trigger_) {
      trigger_->start([allow = config_.allow, happen = std::move(happen)](const Datagram& edge) {
        if (allows(allow, edge.remote.address)) {
          happen(TriggerEdge{});
        }
      });
    }
  }

  void stop() override {
    if (trigger_) {
      trigger_->close();
    }
  }

  // A reboot may have applied an address that the client programmed (protocol/gemini/README.md 3.9).
  void after_step() override {
    const gemini::DeviceAddresses current = device_.addresses();
    if (current == addresses_) {
      return;
    }
    const gemini::DeviceAddresses before = std::exchange(addresses_, current);
    log_.info("head={}: now answers on {} mask {}", name_, address_text(current.alternate),
              address_text(current.netmask));
    if (current.alternate != before.alternate && transport_.local_endpoint().address == before.alternate) {
      move_from(before.alternate);
    }
    announce();
  }

  // Does not follow if a client has programmed another address.
  void follow_addresses(const std::vector<InterfaceAddress>& now) override {
    const InterfaceAddress current{"", addresses_.alternate, addresses_.netmask};
    const auto found = followed(config_.interface, config_.netmask_interface, current, now);
    if (found && addresses_.alternate == followed_) {
      log_.info("head={}: follows {}", name_, followed_text(current, *found));
      followed_ = found->address;
      device_.move_to(found->address, found->netmask);
      after_step();
    }
    const Ipv4 bound = transport_.local_endpoint().address;
    const bool bound_to_it = config_.bind_address == config_.device.alternate_address;
    if (bound_to_it && bound != addresses_.alternate && owner_of(addresses_.alternate, now)) {
      move_from(bound);
    }
  }

  std::optional<std::vector<Ipv4>> own_addresses() const override {
    std::vector<Ipv4> own{addresses_.alternate, transport_.local_endpoint().address};
    if (config_.trigger) {
      own.push_back(config_.trigger->address);
    }
    return own;
  }

 private:
  void move_from(Ipv4 before) {
    try {
      transport_.rebind({addresses_.alternate, config_.command_port});
    } catch (const std::runtime_error& error) {  // a SocketError, or no descriptor is free
      log_.error("head={}: cannot change its address, stays on {}: {}", name_, address_text(before),
                 error.what());
    }
  }

  /// Announces the head's address to clients, by status packets, and in the log.
  void announce() {
    const auto owner = owner_of(addresses_.alternate, interface_addresses());
    std::vector<Endpoint> hosts;
    for (const Ipv4 host : status_hosts(config_.status, addresses_.alternate, addresses_.netmask)) {
      hosts.push_back({host, config_.device.client_port});
    }
    // Sets the source address of status packets. The kernel sets it on a socket bound to one address. On a
    // socket bound to all addresses, a limited broadcast would else leave by the interface of the default
    // route.
    const bool bound_to_all = transport_.local_endpoint().address == 0;
    transport_.set_everybody(std::move(hosts), bound_to_all && owner ? addresses_.alternate : 0);
    transport_.set_own_address(addresses_.alternate);
    if (!owner) {
      log_.warn(
          "head={}: reports the address {}, which this machine does not have, so commands to it are lost "
          "(set network.alternate_address to an address of this machine)",
          name_, address_text(addresses_.alternate));
    } else if (owner->netmask != addresses_.netmask) {
      log_.warn(
          "head={}: reports the netmask {}, but {} has {}: some clients send nothing if the masks differ "
          "(set network.netmask to the mask of the interface)",
          name_, address_text(addresses_.netmask), owner->interface, address_text(owner->netmask));
    }
  }

  const std::string name_;
  const GeminiConfig config_;
  gemini::Device device_;
  UdpTransport transport_;
  std::unique_ptr<UdpEndpoint> trigger_;
  gemini::DeviceAddresses addresses_;
  Ipv4 followed_;  ///< of the interface
  PeerLog log_;    // limited: a client can program addresses and reboot as often as it likes
};

}  // namespace

std::unique_ptr<ConnectedDevice> connect_gemini(const HeadConfig& head, boost::asio::io_context& io,
                                                const Clock& clock) {
  return std::make_unique<ConnectedGemini>(head, io, clock);
}

}  // namespace sonard::server
