// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping360/connected.hpp"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "protocol/ping360/device.hpp"
#include "protocol/ping360/discovery.hpp"
#include "server/devices/ping360/config.hpp"
#include "server/net/several_transports.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {
namespace {

/// Answers discovery requests with the head's address, and ignores requests to change it.
class Discovery {
 public:
  Discovery(const std::string& head, const DiscoveryConfig& config, boost::asio::io_context& io)
      : head_(head), config_(config), socket_(io, config.bind, UdpEndpoint::Sharing::with_others) {}

  void start() {
    socket_.start([this](const Datagram& asked) { answer(asked); });
  }
  void stop() { socket_.close(); }

 private:
  void answer(const Datagram& asked) {
    if (!allows(config_.allow, asked.remote.address)) {
      return;
    }
    const std::span<const std::uint8_t> bytes(asked.bytes.data(), asked.bytes.size());
    const std::optional<Ipv4> wanted = ping360::set_ip(bytes);
    if (wanted) {
      log_.warn(
          "head={}: {} requested the address {}: ignored, sonard does not change the network of this machine",
          head_, address_text(asked.remote.address), address_text(*wanted));
    }
    if (ping360::is_discovery(bytes) || wanted.value_or(0) != 0) {
      const std::string text = ping360::discovery_reply(config_.mac, config_.address);
      socket_.send({{asked.remote, 0, SharedBytes({text.begin(), text.end()})}});
    }
  }

  const std::string head_;
  const DiscoveryConfig config_;
  UdpEndpoint socket_;
  PeerLog log_;
};

class ConnectedPing360 final : public ConnectedDevice {
 public:
  ConnectedPing360(const HeadConfig& head, boost::asio::io_context& io, const Clock& clock)
      : config_(device_settings<Ping360Config>(head)),
        device_(config_.device, clock.now()),
        transport_(open_transports(config_, config_.device.serial_channel >= 0, io, clock)) {
    if (const auto& discovery = config_.discovery) {
      discovery_ = std::make_unique<Discovery>(head.name, *discovery, io);
    }
  }

  Device& device() override { return device_; }
  Transport& transport() override { return transport_; }

  void start(std::function<void(Event)> /*happen*/) override {
    if (discovery_) {
      discovery_->start();
    }
  }
  void stop() override {
    if (discovery_) {
      discovery_->stop();
    }
  }

  std::optional<std::vector<Ipv4>> own_addresses() const override {
    std::vector<Ipv4> own;
    for (const UdpTransportConfig& udp : config_.udp) {
      own.push_back(udp.bind.address);
    }
    for (const PlannedSocket& socket : serial_sockets(config_.serial, "serial")) {
      own.push_back(socket.endpoint.address);
    }
    if (config_.discovery) {
      own.push_back(config_.discovery->address);
    }
    return own;
  }

 private:
  const Ping360Config config_;
  ping360::Device device_;
  SeveralTransports transport_;
  std::unique_ptr<Discovery> discovery_;
};

}  // namespace

std::unique_ptr<ConnectedDevice> connect_ping360(const HeadConfig& head, boost::asio::io_context& io,
                                                 const Clock& clock) {
  return std::make_unique<ConnectedPing360>(head, io, clock);
}

}  // namespace sonard::server
