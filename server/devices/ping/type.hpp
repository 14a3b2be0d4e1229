// SPDX-License-Identifier: Apache-2.0
// What all types of device of the Ping protocol know alike.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "protocol/ping/frame.hpp"
#include "server/devices/device_type.hpp"
#include "server/devices/ping/lines.hpp"

namespace sonard::server {

/// @tparam Config a PingHeadConfig
template <class Config>
class PingType : public DeviceType {
 public:
  bool scanning() const override { return true; }

  // ---- Configuration

  HeadConfig make_default() const override {
    HeadConfig head;
    head.type = this;
    head.device = std::make_shared<Config>();
    head.acoustics = acoustics();
    return head;
  }

  HeadConfig read(YamlSection& section, const HeadContext& context) const override {
    HeadConfig head = make_default();
    head.device = std::make_shared<Config>(read_device(section, context, head));
    return head;
  }

  std::uint16_t device_id(const HeadConfig& head) const override { return settings(head).device.id; }
  std::vector<PlannedSocket> sockets(const HeadConfig& head) const override {
    return planned_sockets(settings(head));
  }
  std::string socket_key() const override { return "udp"; }
  std::vector<Identity> identities(const HeadConfig& head) const override {
    return serial_identities(settings(head).serial, "serial");
  }
  std::string summary(const HeadConfig& head) const override {
    const Config& config = settings(head);
    return fmt::format("ID {}, {}", config.device.id, lines_text(config, config.device.serial_channel >= 0));
  }

  // ---- Playing logs back

  std::optional<std::string> why_not_played(const LoggedHead& logged) const override {
    if (!std::ranges::all_of(logged.pings, [this](const LoggedPing& ping) { return is_ping(ping.wire); })) {
      return fmt::format("pings of device {} lack their wire format (expected wire_line)", logged.device_id);
    }
    return std::nullopt;
  }

  HeadConfig on_loopback(const LoggedHead& logged, Ipv4 address) const override {
    HeadConfig head = make_default();
    auto config = std::make_shared<Config>();
    if (logged.device_id >= least_id() && logged.device_id < ping::broadcast_id) {
      config->device.id = static_cast<std::uint8_t>(logged.device_id);
    }
    config->udp.push_back({{address, usual_port()}, {{0x7F000000, 8}}, {}});
    head.device = std::move(config);
    head.name = logged.name.empty() ? fmt::format("{}-{}", name(), logged.device_id) : logged.name;
    return head;
  }

  HeadConfig held_to_recording(HeadConfig head) const override {
    auto config = std::make_shared<Config>(settings(head));
    config->device.plays_back = true;
    config->device.simulated_time = false;
    head.device = std::move(config);
    return head;
  }

 protected:
  static const Config& settings(const HeadConfig& head) { return device_settings<Config>(head); }

  virtual render::SonarSettings acoustics() const = 0;  ///< by default
  virtual Config read_device(YamlSection& section, const HeadContext& context, HeadConfig& head) const = 0;
  virtual bool is_ping(std::span<const std::uint8_t> wire) const = 0;  ///< that such a head can send
  virtual int least_id() const = 0;
  virtual std::uint16_t usual_port() const = 0;
};

}  // namespace sonard::server
