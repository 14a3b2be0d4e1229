// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping1d/type.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>

#include "protocol/ping1d/device.hpp"
#include "protocol/ping1d/recorded_form.hpp"
#include "protocol/ping1d/scan.hpp"
#include "server/devices/ping1d/config.hpp"
#include "server/devices/ping1d/section.hpp"
#include "server/devices/ping1d/settings.hpp"
#include "server/devices/ping1d/survey.hpp"
#include "server/net/serial_transport.hpp"
#include "server/net/several_transports.hpp"

namespace sonard::server {
namespace {

std::vector<std::unique_ptr<Transport>> open_transports(const Ping1dConfig& config,
                                                        boost::asio::io_context& io, const Clock& clock) {
  std::vector<std::unique_ptr<Transport>> transports;
  for (const UdpTransportConfig& udp : config.udp) {
    transports.push_back(std::make_unique<UdpTransport>(io, clock, udp));
  }
  if (config.device.serial_channel >= 0) {
    transports.push_back(std::make_unique<SerialTransport>(io, clock, config.serial));
  }
  return transports;
}

class ConnectedPing1d final : public ConnectedDevice {
 public:
  ConnectedPing1d(const Ping1dConfig& config, boost::asio::io_context& io, const Clock& clock)
      : device_(config.device, clock.now()), transport_(open_transports(config, io, clock)) {}

  Device& device() override { return device_; }
  Transport& transport() override { return transport_; }

 private:
  ping1d::Device device_;
  SeveralTransports transport_;
};

class Ping1dType final : public DeviceType {
 public:
  std::string_view name() const override { return "ping1d"; }
  std::string_view title() const override { return "Ping1D"; }
  std::vector<std::string_view> models() const override { return {"ping2"}; }
  bool scanning() const override { return true; }
  bool turns() const override { return false; }
  std::vector<Counter> counters() const override { return ping1d::Device({}, {}).counts(); }

  // ---- Configuration

  HeadConfig make_default() const override {
    HeadConfig head;
    head.type = this;
    head.device = std::make_shared<Ping1dConfig>();
    head.acoustics = ping1d_acoustics(Ping1dModel::ping1d);
    return head;
  }

  HeadConfig read(YamlSection& section, const HeadContext& context) const override {
    HeadConfig head = make_default();
    head.device = std::make_shared<Ping1dConfig>(read_ping1d_head(section, context, head));
    return head;
  }

  std::uint16_t device_id(const HeadConfig& head) const override {
    return device_settings<Ping1dConfig>(head).device.id;
  }

  std::vector<PlannedSocket> sockets(const HeadConfig& head) const override {
    const Ping1dConfig& config = device_settings<Ping1dConfig>(head);
    std::vector<PlannedSocket> sockets = serial_sockets(config.serial, "serial");
    for (std::size_t i = 0; i < config.udp.size(); ++i) {
      sockets.push_back({PlannedSocket::Transport::udp, config.udp[i].bind, fmt::format("udp[{}].bind", i)});
    }
    return sockets;
  }
  std::string socket_key() const override { return "udp"; }

  std::vector<Identity> identities(const HeadConfig& head) const override {
    return serial_identities(device_settings<Ping1dConfig>(head).serial, "serial");
  }

  std::string summary(const HeadConfig& head) const override {
    const Ping1dConfig& config = device_settings<Ping1dConfig>(head);
    std::vector<std::string> ways;
    for (const UdpTransportConfig& udp : config.udp) {
      ways.push_back("UDP " + endpoint_text(udp.bind));
    }
    if (config.device.serial_channel >= 0) {
      ways.push_back("serial by " + serial_text(config.serial));
    }
    return fmt::format("ID {}, {}", config.device.id, fmt::join(ways, ", "));
  }

  // ---- Serving

  std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                           const Clock& clock) const override {
    return std::make_unique<ConnectedPing1d>(device_settings<Ping1dConfig>(head), io, clock);
  }

  PingJob usual_job(const HeadConfig& head) const override {
    return ping1d::make_job(ping1d::usual_scan, device_settings<Ping1dConfig>(head).device);
  }

  render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const override {
    return ping1d_sonar_settings(job, head);
  }

  // ---- Playing logs back

  std::optional<std::string> why_not_played(const LoggedHead& logged) const override {
    const auto told = [](const LoggedPing& ping) { return ping1d::recorded_form(ping.wire).has_value(); };
    if (!std::ranges::all_of(logged.pings, told)) {
      return fmt::format("pings of device {} lack their wire format (expected wire_line)", logged.device_id);
    }
    return std::nullopt;
  }

  HeadConfig on_loopback(const LoggedHead& logged, Ipv4 address) const override {
    HeadConfig head = make_default();
    auto config = std::make_shared<Ping1dConfig>();
    if (logged.device_id < ping::broadcast_id) {
      config->device.id = static_cast<std::uint8_t>(logged.device_id);
    }
    config->udp.push_back({{address, ping1d_bridge_port}, {{0x7F000000, 8}}, {}});
    head.device = std::move(config);
    head.name = logged.name.empty() ? fmt::format("ping1d-{}", logged.device_id) : logged.name;
    return head;
  }

  HeadConfig held_to_recording(HeadConfig head) const override {
    auto config = std::make_shared<Ping1dConfig>(device_settings<Ping1dConfig>(head));
    config->device.plays_back = true;
    config->device.simulated_time = false;
    head.device = std::move(config);
    return head;
  }

  std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const override {
    return survey_of_ping1d(head, options);
  }
};

}  // namespace

const DeviceType& ping1d_type() {
  static const Ping1dType type;
  return type;
}

}  // namespace sonard::server
