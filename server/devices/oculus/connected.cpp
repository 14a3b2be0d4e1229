// SPDX-License-Identifier: Apache-2.0
#include "server/devices/oculus/connected.hpp"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "protocol/oculus/device.hpp"
#include "server/devices/oculus/config.hpp"
#include "server/net/several_transports.hpp"
#include "server/net/tcp_transport.hpp"
#include "server/net/udp_transport.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {
namespace {

class ConnectedOculus final : public ConnectedDevice {
 public:
  ConnectedOculus(const HeadConfig& head, boost::asio::io_context& io, const Clock& clock)
      : name_(head.name),
        config_(device_settings<OculusConfig>(head)),
        address_(config_.device.address),
        netmask_(config_.device.netmask),
        device_(config_.device, clock.now()),
        transport_(open_transports(io, clock)) {
    tell_everybody();
  }

  Device& device() override { return device_; }
  Transport& transport() override { return transport_; }

  void follow_addresses(const std::vector<InterfaceAddress>& now) override {
    const InterfaceAddress current{"", address_, netmask_};
    const auto found = followed(config_.interface, config_.netmask_interface, current, now);
    if (!found) {
      return;
    }
    try {
      if (found->address != address_) {
        stream_->rebind({found->address, config_.tcp_port});
        status_->rebind({found->address, 0});
      }
    } catch (const std::runtime_error& error) {  // a SocketError, or no descriptor is free
      log_.error("head={}: cannot follow {} to {}: {}", name_, found->interface, address_text(found->address),
                 error.what());
      return;
    }
    log_.info("head={}: follows {}", name_, followed_text(current, *found));
    address_ = found->address;
    netmask_ = found->netmask;
    device_.move_to(address_, netmask_);
    tell_everybody();
  }

  std::optional<std::vector<Ipv4>> own_addresses() const override { return std::vector<Ipv4>{address_}; }

 private:
  std::vector<std::unique_ptr<Transport>> open_transports(boost::asio::io_context& io, const Clock& clock) {
    static_assert(oculus::Device::stream_channel == 0 && oculus::Device::status_channel == 1);
    auto stream = std::make_unique<TcpTransport>(
        io, TcpTransportConfig{{address_, config_.tcp_port}, config_.allow}, clock);
    // Some drivers connect to the source address of status packets, so these leave from the address of the
    // TCP socket.
    auto status = std::make_unique<UdpTransport>(
        io, clock, UdpTransportConfig{.bind = {address_, 0}, .allow = {}, .link = {}});
    stream_ = stream.get();
    status_ = status.get();
    std::vector<std::unique_ptr<Transport>> transports;
    transports.push_back(std::move(stream));
    transports.push_back(std::move(status));
    return transports;
  }

  void tell_everybody() {
    std::vector<Endpoint> hosts;
    for (const Ipv4 host : status_hosts(config_.status, address_, netmask_)) {
      hosts.push_back({host, config_.status_port});
    }
    status_->set_everybody(std::move(hosts), 0);
  }

  const std::string name_;
  const OculusConfig config_;
  Ipv4 address_, netmask_;
  oculus::Device device_;
  TcpTransport* stream_ = nullptr;  ///< owned by transport_
  UdpTransport* status_ = nullptr;  ///< owned by transport_
  SeveralTransports transport_;
  PeerLog log_;
};

}  // namespace

std::unique_ptr<ConnectedDevice> connect_oculus(const HeadConfig& head, boost::asio::io_context& io,
                                                const Clock& clock) {
  return std::make_unique<ConnectedOculus>(head, io, clock);
}

}  // namespace sonard::server
