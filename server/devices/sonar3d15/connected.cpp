// SPDX-License-Identifier: Apache-2.0
#include "server/devices/sonar3d15/connected.hpp"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "protocol/sonar3d15/device.hpp"
#include "server/devices/sonar3d15/config.hpp"
#include "server/net/several_transports.hpp"
#include "server/net/tcp_transport.hpp"
#include "server/net/udp_transport.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {
namespace {

sonar3d15::DeviceConfig with_clock(sonar3d15::DeviceConfig device, std::uint64_t seed) {
  device.utc_offset = unix_time_offset();
  device.seed = seed;
  return device;
}

class ConnectedSonar3d15 final : public ConnectedDevice {
 public:
  ConnectedSonar3d15(const HeadConfig& head, boost::asio::io_context& io, const Clock& clock)
      : name_(head.name),
        config_(device_settings<Sonar3d15Config>(head)),
        address_(config_.address),
        device_(with_clock(config_.device, head.seed), clock.now()),
        transport_(open_transports(io, clock)) {}

  Device& device() override { return device_; }
  Transport& transport() override { return transport_; }

  void follow_addresses(const std::vector<InterfaceAddress>& now) override {
    const InterfaceAddress current{"", address_, 0xFFFFFFFF};
    const auto found = followed(config_.interface, "", current, now);
    if (!found || found->address == address_) {
      return;
    }
    try {
      control_->rebind({found->address, config_.http_port});
      images_->rebind({found->address, 0});
    } catch (const std::runtime_error& error) {  // a SocketError, or no descriptor is free
      log_.error("head={}: cannot follow {} to {}: {}", name_, found->interface, address_text(found->address),
                 error.what());
      return;
    }
    log_.info("head={}: follows {}", name_, followed_text(current, *found));
    address_ = found->address;
  }

  std::optional<std::vector<Ipv4>> own_addresses() const override { return std::vector<Ipv4>{address_}; }

 private:
  // Clients drop images from another address than that of the HTTP interface. Multicast leaves by the
  // interface with the address that its socket is bound to.
  std::vector<std::unique_ptr<Transport>> open_transports(boost::asio::io_context& io, const Clock& clock) {
    static_assert(sonar3d15::Device::control_channel == 0 && sonar3d15::Device::image_channel == 1);
    auto control = std::make_unique<TcpTransport>(
        io, TcpTransportConfig{{address_, config_.http_port}, config_.allow}, clock);
    auto images = std::make_unique<UdpTransport>(
        io, clock,
        UdpTransportConfig{
            .bind = {address_, 0}, .allow = {}, .link = {}, .multicast_ttl = config_.multicast_ttl});
    control_ = control.get();
    images_ = images.get();
    std::vector<std::unique_ptr<Transport>> transports;
    transports.push_back(std::move(control));
    transports.push_back(std::move(images));
    return transports;
  }

  const std::string name_;
  const Sonar3d15Config config_;
  Ipv4 address_;
  sonar3d15::Device device_;
  TcpTransport* control_ = nullptr;  ///< owned by transport_
  UdpTransport* images_ = nullptr;   ///< owned by transport_
  SeveralTransports transport_;
  PeerLog log_;
};

}  // namespace

std::unique_ptr<ConnectedDevice> connect_sonar3d15(const HeadConfig& head, boost::asio::io_context& io,
                                                   const Clock& clock) {
  return std::make_unique<ConnectedSonar3d15>(head, io, clock);
}

}  // namespace sonard::server
