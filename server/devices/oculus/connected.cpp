// SPDX-License-Identifier: Apache-2.0
#include "server/devices/oculus/connected.hpp"

#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "protocol/oculus/device.hpp"
#include "server/devices/oculus/config.hpp"
#include "server/net/several_transports.hpp"
#include "server/net/tcp_transport.hpp"
#include "server/net/udp_transport.hpp"

namespace sonard::server {
namespace {

/// Clients of some drivers connect to where status packets come from: they leave from the address that is
/// connected to.
std::unique_ptr<Transport> status_sender(const OculusConfig& config, boost::asio::io_context& io,
                                         const Clock& clock) {
  const oculus::DeviceConfig& device = config.device;
  auto sender = std::make_unique<UdpTransport>(
      io, clock, UdpTransportConfig{.bind = {device.address, 0}, .allow = {}, .link = {}});
  std::vector<Endpoint> hosts;
  for (const Ipv4 host : status_hosts(config.status, device.address, device.netmask)) {
    hosts.push_back({host, config.status_port});
  }
  sender->set_everybody(std::move(hosts), 0);
  return sender;
}

std::vector<std::unique_ptr<Transport>> open_transports(const OculusConfig& config,
                                                        boost::asio::io_context& io, const Clock& clock) {
  static_assert(oculus::Device::stream_channel == 0 && oculus::Device::status_channel == 1);
  std::vector<std::unique_ptr<Transport>> transports;
  transports.push_back(std::make_unique<TcpTransport>(
      io, TcpTransportConfig{{config.device.address, config.tcp_port}, config.allow}));
  transports.push_back(status_sender(config, io, clock));
  return transports;
}

class ConnectedOculus final : public ConnectedDevice {
 public:
  ConnectedOculus(const HeadConfig& head, boost::asio::io_context& io, const Clock& clock)
      : device_(oculus_config(head).device, clock.now()),
        transport_(open_transports(oculus_config(head), io, clock)) {}

  Device& device() override { return device_; }
  Transport& transport() override { return transport_; }

 private:
  oculus::Device device_;
  SeveralTransports transport_;
};

}  // namespace

std::unique_ptr<ConnectedDevice> connect_oculus(const HeadConfig& head, boost::asio::io_context& io,
                                                const Clock& clock) {
  return std::make_unique<ConnectedOculus>(head, io, clock);
}

}  // namespace sonard::server
