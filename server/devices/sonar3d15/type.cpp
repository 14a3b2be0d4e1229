// SPDX-License-Identifier: Apache-2.0
#include "server/devices/sonar3d15/type.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include <fmt/format.h>

#include "protocol/sonar3d15/device.hpp"
#include "protocol/sonar3d15/shot.hpp"
#include "renderer/acoustics/water.hpp"
#include "server/devices/sonar3d15/config.hpp"
#include "server/devices/sonar3d15/connected.hpp"
#include "server/devices/sonar3d15/packet_log.hpp"
#include "server/devices/sonar3d15/section.hpp"
#include "server/devices/sonar3d15/settings.hpp"
#include "server/devices/sonar3d15/survey.hpp"
#include "server/logs/log_summary.hpp"

namespace sonard::server {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

std::string destination_text(const sonar3d15::DeviceConfig& device) {
  switch (device.udp_mode) {
    case sonar3d15::UdpMode::multicast:
      return "images to " + endpoint_text(sonar3d15::multicast_group);
    case sonar3d15::UdpMode::unicast:
      return "images to " + endpoint_text(device.unicast);
    default:
      return "no images";
  }
}

class Sonar3d15Type final : public DeviceType, public CaptureReader, public PacketLogDevice {
 public:
  std::string_view name() const override { return "sonar3d15"; }
  std::string_view title() const override { return "Sonar 3D-15"; }
  bool scanning() const override { return false; }
  bool has_sensors() const override { return true; }

  // ---- Configuration

  HeadConfig make_default() const override {
    HeadConfig head;
    head.type = this;
    head.device = std::make_shared<Sonar3d15Config>(sonar3d15_defaults());
    return head;
  }

  HeadConfig read(YamlSection& section, const HeadContext& context) const override {
    HeadConfig head = make_default();
    head.device = std::make_shared<Sonar3d15Config>(read_sonar3d15_head(section, context, head));
    return head;
  }

  std::uint16_t device_id(const HeadConfig& head) const override {
    return device_settings<Sonar3d15Config>(head).id;
  }

  std::vector<PlannedSocket> sockets(const HeadConfig& head) const override {
    const Sonar3d15Config& config = device_settings<Sonar3d15Config>(head);
    return {{PlannedSocket::Transport::tcp, {config.address, config.http_port}, "network.address"}};
  }
  std::string socket_key() const override { return "network.address"; }

  /// Clients tell heads by the source address of the images.
  std::vector<Identity> identities(const HeadConfig& head) const override {
    return {{"network.address", address_text(device_settings<Sonar3d15Config>(head).address)}};
  }

  std::string summary(const HeadConfig& head) const override {
    const Sonar3d15Config& config = device_settings<Sonar3d15Config>(head);
    return fmt::format("HTTP {}, {}", endpoint_text({config.address, config.http_port}),
                       destination_text(config.device));
  }

  // ---- Serving

  std::vector<Counter> counters() const override { return sonar3d15::Device({}, {}).counts(); }

  std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                           const Clock& clock) const override {
    return connect_sonar3d15(head, io, clock);
  }

  PingJob usual_job(const HeadConfig& head) const override {
    const sonar3d15::DeviceConfig& device = device_settings<Sonar3d15Config>(head).device;
    sonar3d15::Settings settings;
    settings.least_range_m = device.least_range_m;
    settings.range_m = device.range_m;
    return sonar3d15::make_job(device, settings, device.automatic_sound_speed_mps);
  }

  render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const override {
    return sonar3d15_sonar_settings(job, head);
  }

  std::optional<CapturedPing> ping_in(std::span<const std::uint8_t> datagram) const override {
    const auto message = sonar3d15::decode(datagram);
    const auto* const image = message ? std::get_if<sonar3d15::RangeImage>(&*message) : nullptr;
    if (image == nullptr) {
      return std::nullopt;
    }
    return CapturedPing{std::string(name()),
                        0,
                        {.bins = sonar3d15::fan_bins,
                         .beams = static_cast<int>(image->width()),
                         .bin_m = static_cast<double>(image->range()) / sonar3d15::fan_bins,
                         .sound_speed_mps = static_cast<double>(image->speed_of_sound())}};
  }

  LogKind packet_log() const override { return LogKind::sonar; }
  std::unique_ptr<LogReader> open_packet_log(const LogFile& file) const override {
    return read_sonar3d15_log(file, std::string(name()));
  }

  // ---- Playing logs back

  std::optional<std::string> why_not_played(const LoggedHead& logged) const override {
    const auto told = [](const LoggedPing& ping) { return sonar3d15::recorded_form(ping.wire).has_value(); };
    if (!std::ranges::all_of(logged.pings, told)) {
      return fmt::format("pings of head '{}' lack their wire format (expected both images)", logged.name);
    }
    return std::nullopt;
  }

  HeadConfig on_loopback(const LoggedHead& logged, Ipv4 address) const override {
    HeadConfig head = make_default();
    auto config = std::make_shared<Sonar3d15Config>(device_settings<Sonar3d15Config>(head));
    config->address = address;
    config->allow = {{0x7F000000, 8}};
    head.device = std::move(config);
    head.name = logged.name.empty() ? "sonar3d15" : logged.name;
    return head;
  }

  HeadConfig held_to_recording(HeadConfig head) const override {
    auto config = std::make_shared<Sonar3d15Config>(device_settings<Sonar3d15Config>(head));
    config->device.plays_back = true;
    config->device.simulated_time = false;
    head.device = std::move(config);
    return head;
  }

  std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const override {
    return survey_of_sonar3d15(head, options);
  }
};

}  // namespace

const DeviceType& sonar3d15_type() {
  static const Sonar3d15Type type;
  return type;
}

// Product page: 0.85 x 1.6 degrees at the low frequency, 0.45 x 0.85 at the high one. With this gain, signals
// of a docking station and the bed around it lie within 1 and 145, as those of the recording lie within 1 and
// 170.
Sonar3d15Config sonar3d15_defaults() {
  constexpr double gain_db = 130.0;
  const render::Water water;
  Sonar3d15Config config;
  config.device.gain = std::pow(10.0, gain_db / 20.0);
  config.modes = {{{0.85 * degree, 1.6 * degree,
                    render::francois_garrison_absorption_db_per_m(config.device.low.carrier_hz, water)},
                   {0.45 * degree, 0.85 * degree,
                    render::francois_garrison_absorption_db_per_m(config.device.high.carrier_hz, water)}}};
  return config;
}

}  // namespace sonard::server
