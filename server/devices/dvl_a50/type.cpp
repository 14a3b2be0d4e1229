// SPDX-License-Identifier: Apache-2.0
#include "server/devices/dvl_a50/type.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/asio/io_context.hpp>

#include "protocol/dvl_a50/device.hpp"
#include "protocol/dvl_a50/measurement.hpp"
#include "protocol/dvl_a50/recorded_form.hpp"
#include "server/devices/dvl_a50/config.hpp"
#include "server/devices/dvl_a50/section.hpp"
#include "server/devices/dvl_a50/settings.hpp"
#include "server/devices/dvl_a50/survey.hpp"
#include "server/net/serial_transport.hpp"
#include "server/net/several_transports.hpp"

namespace sonard::server {
namespace {

constexpr std::chrono::seconds stall_limit{10};  ///< protocol/dvl_a50/README.md 9

/// Its optional sockets with their keys, in the order of the channels.
std::vector<std::pair<const TcpTransportConfig*, std::string>> sockets_of(const DvlConfig& config) {
  std::vector<std::pair<const TcpTransportConfig*, std::string>> sockets{{&config.json, "tcp"}};
  const auto add = [&](const std::optional<TcpTransportConfig>& tcp, const char* key) {
    if (tcp) {
      sockets.emplace_back(&*tcp, key);
    }
  };
  add(config.pd6, "pd6");
  add(config.pd4, "pd4");
  add(config.http, "http");
  return sockets;
}

std::vector<std::unique_ptr<Transport>> open_transports(const DvlConfig& config, boost::asio::io_context& io,
                                                        const Clock& clock) {
  std::vector<std::unique_ptr<Transport>> transports;
  for (const auto& socket : sockets_of(config)) {
    TcpTransportConfig tcp = *socket.first;
    tcp.stall_limit = stall_limit;
    transports.push_back(std::make_unique<TcpTransport>(io, tcp, clock));
  }
  if (config.device.serial_channel >= 0) {
    transports.push_back(std::make_unique<SerialTransport>(io, clock, config.serial));
  }
  return transports;
}

dvl_a50::DeviceConfig with_wall_clock(dvl_a50::DeviceConfig device) {
  device.unix_offset = unix_time_offset();
  return device;
}

class ConnectedDvl final : public ConnectedDevice {
 public:
  ConnectedDvl(const DvlConfig& config, boost::asio::io_context& io, const Clock& clock)
      : device_(with_wall_clock(config.device), clock.now()),
        transport_(open_transports(config, io, clock)) {}

  Device& device() override { return device_; }
  Transport& transport() override { return transport_; }

 private:
  dvl_a50::Device device_;
  SeveralTransports transport_;
};

class DvlType final : public DeviceType {
 public:
  std::string_view name() const override { return "dvl_a50"; }
  std::string_view title() const override { return "DVL A50"; }
  std::vector<std::string_view> models() const override { return {"a50", "a125"}; }
  bool scanning() const override { return true; }
  bool turns() const override { return false; }
  bool has_sensors() const override { return true; }
  std::vector<Counter> counters() const override {
    return dvl_a50::Device(dvl_a50::DeviceConfig{}, {}).counts();
  }

  // ---- Configuration

  HeadConfig make_default() const override {
    HeadConfig head;
    head.type = this;
    head.device = std::make_shared<DvlConfig>();
    head.acoustics = dvl_acoustics(dvl_a50::Model::a50);
    return head;
  }

  HeadConfig read(YamlSection& section, const HeadContext& context) const override {
    HeadConfig head = make_default();
    head.device = std::make_shared<DvlConfig>(read_dvl_head(section, context, head));
    return head;
  }

  std::uint16_t device_id(const HeadConfig& head) const override {
    device_settings<DvlConfig>(head);
    return 1;  // it has no number on its line
  }

  std::vector<PlannedSocket> sockets(const HeadConfig& head) const override {
    const DvlConfig& config = device_settings<DvlConfig>(head);
    std::vector<PlannedSocket> sockets = serial_sockets(config.serial, "serial");
    for (const auto& [tcp, key] : sockets_of(config)) {
      sockets.push_back({PlannedSocket::Transport::tcp, tcp->bind, key + ".bind"});
    }
    return sockets;
  }
  std::string socket_key() const override { return "tcp.bind"; }

  std::vector<Identity> identities(const HeadConfig& head) const override {
    return serial_identities(device_settings<DvlConfig>(head).serial, "serial");
  }

  std::string summary(const HeadConfig& head) const override {
    const DvlConfig& config = device_settings<DvlConfig>(head);
    std::vector<std::string> ways;
    for (const auto& [tcp, key] : sockets_of(config)) {
      ways.push_back(fmt::format("{} {}", key == "tcp" ? "JSON" : key, endpoint_text(tcp->bind)));
    }
    if (config.device.serial_channel >= 0) {
      ways.push_back("serial by " + serial_text(config.serial));
    }
    return fmt::format("{}, {}", config.device.product_name, fmt::join(ways, ", "));
  }

  // ---- Serving

  std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                           const Clock& clock) const override {
    return std::make_unique<ConnectedDvl>(device_settings<DvlConfig>(head), io, clock);
  }

  PingJob usual_job(const HeadConfig& head) const override {
    const dvl_a50::DeviceConfig& device = device_settings<DvlConfig>(head).device;
    return dvl_a50::make_job(dvl_a50::plan_ping(std::nullopt, device, device.settings), device);
  }

  render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const override {
    return dvl_sonar_settings(job, head);
  }

  // ---- Playing logs back

  std::optional<std::string> why_not_played(const LoggedHead& logged) const override {
    const auto told = [](const LoggedPing& ping) { return dvl_a50::recorded_form(ping.wire).has_value(); };
    if (!std::ranges::all_of(logged.pings, told)) {
      return "pings of a DVL lack their wire format (expected wire_line)";
    }
    return std::nullopt;
  }

  HeadConfig on_loopback(const LoggedHead& logged, Ipv4 address) const override {
    HeadConfig head = make_default();
    auto config = std::make_shared<DvlConfig>();
    config->json = {{address, dvl_json_port}, {{0x7F000000, 8}}};
    head.device = std::move(config);
    head.name = logged.name.empty() ? "dvl" : logged.name;
    return head;
  }

  HeadConfig held_to_recording(HeadConfig head) const override {
    auto config = std::make_shared<DvlConfig>(device_settings<DvlConfig>(head));
    config->device.plays_back = true;
    config->device.simulated_time = false;
    head.device = std::move(config);
    return head;
  }

  std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const override {
    return survey_of_dvl(head, options);
  }
};

}  // namespace

const DeviceType& dvl_a50_type() {
  static const DvlType type;
  return type;
}

}  // namespace sonard::server
