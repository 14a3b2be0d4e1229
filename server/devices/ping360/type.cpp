// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping360/type.hpp"

#include <algorithm>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "protocol/ping360/device.hpp"
#include "protocol/ping360/make_job.hpp"
#include "protocol/ping360/recorded_form.hpp"
#include "protocol/ping360/usual_scan.hpp"
#include "server/devices/ping360/config.hpp"
#include "server/devices/ping360/connected.hpp"
#include "server/devices/ping360/section.hpp"
#include "server/devices/ping360/settings.hpp"
#include "server/devices/ping360/survey.hpp"

namespace sonard::server {
namespace {

class Ping360Type final : public DeviceType {
 public:
  std::string_view name() const override { return "ping360"; }
  std::string_view title() const override { return "Ping360"; }
  bool scanning() const override { return true; }

  // ---- Configuration

  HeadConfig make_default() const override {
    HeadConfig head;
    head.type = this;
    head.device = std::make_shared<Ping360Config>();
    head.acoustics = ping360_acoustics();
    return head;
  }

  HeadConfig read(YamlSection& section, const HeadContext& context) const override {
    HeadConfig head = make_default();
    head.device = std::make_shared<Ping360Config>(read_ping360_head(section, context, head));
    return head;
  }

  std::uint16_t device_id(const HeadConfig& head) const override {
    return device_settings<Ping360Config>(head).device.id;
  }

  std::vector<PlannedSocket> sockets(const HeadConfig& head) const override {
    const Ping360Config& config = device_settings<Ping360Config>(head);
    std::vector<PlannedSocket> sockets = serial_sockets(config.serial, "serial");
    for (std::size_t i = 0; i < config.udp.size(); ++i) {
      sockets.push_back({PlannedSocket::Transport::udp, config.udp[i].bind, fmt::format("udp[{}].bind", i)});
    }
    return sockets;  // the discovery socket is shared, so it is not listed
  }
  std::string socket_key() const override { return "udp"; }

  std::vector<Identity> identities(const HeadConfig& head) const override {
    return serial_identities(device_settings<Ping360Config>(head).serial, "serial");
  }

  std::string summary(const HeadConfig& head) const override {
    const Ping360Config& config = device_settings<Ping360Config>(head);
    std::vector<std::string> ways;
    for (const UdpTransportConfig& udp : config.udp) {
      ways.push_back("UDP " + endpoint_text(udp.bind));
    }
    if (config.device.serial_channel >= 0) {
      ways.push_back("serial by " + serial_text(config.serial));
    }
    return fmt::format("ID {}, {}{}", config.device.id, fmt::join(ways, ", "),
                       config.discovery ? ", found as " + address_text(config.discovery->address) : "");
  }

  // ---- Serving

  std::vector<Counter> counters() const override { return ping360::Device({}, {}).counts(); }

  std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                           const Clock& clock) const override {
    return connect_ping360(head, io, clock);
  }

  PingJob usual_job(const HeadConfig& head) const override {
    const ping360::DeviceConfig& device = device_settings<Ping360Config>(head).device;
    ping360::AutoTransmit scan =
        ping360::usual_scan(10.0, std::nullopt, 1500.0, device.bearing_offset).value();
    scan.gain_setting = 1;
    return ping360::make_job(ping360::form_of(scan, device.bearing_offset), device);
  }

  render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const override {
    return ping360_sonar_settings(job, head);
  }

  // ---- Playing logs back

  std::optional<std::string> why_not_played(const LoggedHead& logged) const override {
    const auto told = [](const LoggedPing& ping) { return ping360::recorded_form(ping.wire).has_value(); };
    if (!std::ranges::all_of(logged.pings, told)) {
      return fmt::format("pings of device {} lack their wire format (expected wire_line)", logged.device_id);
    }
    return std::nullopt;
  }

  HeadConfig on_loopback(const LoggedHead& logged, Ipv4 address) const override {
    HeadConfig head = make_default();
    auto config = std::make_shared<Ping360Config>();
    if (logged.device_id >= 1 && logged.device_id <= 254) {
      config->device.id = static_cast<std::uint8_t>(logged.device_id);
    }
    config->udp.push_back({{address, ping360_data_port}, {{0x7F000000, 8}}, {}});
    head.device = std::move(config);
    head.name = logged.name.empty() ? fmt::format("ping360-{}", logged.device_id) : logged.name;
    return head;
  }

  HeadConfig held_to_recording(HeadConfig head) const override {
    auto config = std::make_shared<Ping360Config>(device_settings<Ping360Config>(head));
    config->device.plays_back = true;
    config->device.simulated_time = false;
    head.device = std::move(config);
    return head;
  }

  std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const override {
    return survey_of_ping360(head, options);
  }
};

}  // namespace

const DeviceType& ping360_type() {
  static const Ping360Type type;
  return type;
}

// Beam of 2 by 25 degrees, from the maker's data sheet. The law of the samples is not published. Assumed:
// half decibels, as in the other scanning head, with a wall 5 m away in the upper half of the scale. Nearer
// than 0.75 m the transducer rings, and images of owners are bright from the first sample on
// (docs/protocols/ping360.md 2.3).
render::SonarSettings ping360_acoustics() {
  constexpr double degree = std::numbers::pi / 180.0;
  render::SonarSettings acoustics;
  acoustics.aperture.beam_edges_rad = {1.0 * degree, -1.0 * degree};
  acoustics.aperture.receive_beamwidth_rad = 2.0 * degree;
  acoustics.aperture.vertical_beamwidth_rad = 25.0 * degree;
  acoustics.aperture.elevation = render::Aperture::Elevation::sinc_two_way;  // same transducer both ways
  acoustics.output_scale = render::OutputScale::half_decibels;
  acoustics.physical.multipath.most_bounces = 6;
  acoustics.physical.pulse.shape = render::PulseSettings::Shape::tone;
  acoustics.physical.gain_db = -9.0;
  acoustics.physical.tvg.max_db = 75.0;
  acoustics.physical.noise.level_db = -141.0;
  acoustics.physical.near_field_blank_m = 0.0;
  acoustics.physical.ring_down.on = true;
  acoustics.physical.ring_down.end_m = 0.75;
  acoustics.physical.ring_down.from_start = true;
  acoustics.physical.noise.broadside_stripe_db = 0.0;
  return acoustics;
}

}  // namespace sonard::server
