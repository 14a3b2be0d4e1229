// SPDX-License-Identifier: Apache-2.0
#include "server/devices/micron/type.hpp"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>

#include "protocol/micron/device.hpp"
#include "protocol/micron/line_job.hpp"
#include "protocol/micron/recorded_form.hpp"
#include "protocol/micron/scan_settings.hpp"
#include "protocol/micron/units.hpp"
#include "server/devices/micron/config.hpp"
#include "server/devices/micron/section.hpp"
#include "server/devices/micron/settings.hpp"
#include "server/devices/micron/survey.hpp"
#include "server/devices/single_beam.hpp"
#include "server/net/serial_transport.hpp"

namespace sonard::server {
namespace {

constexpr std::uint16_t loopback_port = 4001;  // usual for serial device servers

class ConnectedMicron final : public ConnectedDevice {
 public:
  ConnectedMicron(const MicronConfig& config, boost::asio::io_context& io, const Clock& clock)
      : device_(config.device, clock.now()), transport_(io, clock, config.serial) {}

  Device& device() override { return device_; }
  Transport& transport() override { return transport_; }

 private:
  micron::Device device_;
  SerialTransport transport_;
};

class MicronType final : public DeviceType {
 public:
  std::string_view name() const override { return "micron"; }
  std::string_view title() const override { return "Micron"; }
  bool scanning() const override { return true; }

  // ---- Configuration

  HeadConfig make_default() const override {
    HeadConfig head;
    head.type = this;
    head.device = std::make_shared<MicronConfig>();
    head.acoustics = micron_acoustics();
    return head;
  }

  HeadConfig read(YamlSection& section, const HeadContext& context) const override {
    HeadConfig head = make_default();
    head.device = std::make_shared<MicronConfig>(read_micron_head(section, context, head));
    return head;
  }

  std::uint16_t device_id(const HeadConfig& head) const override {
    return device_settings<MicronConfig>(head).device.node;
  }

  std::vector<PlannedSocket> sockets(const HeadConfig& head) const override {
    return serial_sockets(device_settings<MicronConfig>(head).serial, "serial");
  }
  std::string socket_key() const override { return "serial"; }

  std::vector<Identity> identities(const HeadConfig& head) const override {
    return serial_identities(device_settings<MicronConfig>(head).serial, "serial");
  }

  std::string summary(const HeadConfig& head) const override {
    const MicronConfig& config = device_settings<MicronConfig>(head);
    return fmt::format("node {}, {} duplex, line by {}", config.device.node,
                       config.device.half_duplex ? "half" : "full", serial_text(config.serial));
  }

  // ---- Serving

  std::vector<Counter> counters() const override { return micron::Device({}, {}).counts(); }

  std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                           const Clock& clock) const override {
    return std::make_unique<ConnectedMicron>(device_settings<MicronConfig>(head), io, clock);
  }

  PingJob usual_job(const HeadConfig& head) const override {
    return micron::make_line_job(micron::make_head_command({}), device_settings<MicronConfig>(head).device,
                                 micron::bearing_ahead);
  }

  render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const override {
    return micron_sonar_settings(job, head);
  }

  // ---- Playing logs back

  std::optional<std::string> why_not_played(const LoggedHead& logged) const override {
    const auto told = [](const LoggedPing& ping) { return micron::recorded_line(ping.wire).has_value(); };
    if (!std::ranges::all_of(logged.pings, told)) {
      return fmt::format("scan lines of node {} lack their wire format (expected wire_line)",
                         logged.device_id);
    }
    const auto short_enough = [](const LoggedPing& ping) { return ping.settings.bins <= micron::max_bins; };
    if (!std::ranges::all_of(logged.pings, short_enough)) {
      return fmt::format("scan lines of node {} have too many bins (expected at most {}, as a Micron sends)",
                         logged.device_id, micron::max_bins);
    }
    return std::nullopt;
  }

  HeadConfig on_loopback(const LoggedHead& logged, Ipv4 address) const override {
    HeadConfig head = make_default();
    auto config = std::make_shared<MicronConfig>();
    if (logged.device_id >= 1 && logged.device_id < micron::client_node) {
      config->device.node = static_cast<std::uint8_t>(logged.device_id);
    }
    config->serial.tcp.push_back({{address, loopback_port}, {{0x7F000000, 8}}});
    head.device = std::move(config);
    head.name = logged.name.empty() ? fmt::format("micron-{}", logged.device_id) : logged.name;
    return head;
  }

  HeadConfig held_to_recording(HeadConfig head) const override {
    auto config = std::make_shared<MicronConfig>(device_settings<MicronConfig>(head));
    config->device.plays_back = true;
    config->device.simulated_time = false;
    head.device = std::move(config);
    return head;
  }

  std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const override {
    return survey_of_micron(head, options);
  }
};

}  // namespace

const DeviceType& micron_type() {
  static const MicronType type;
  return type;
}

// Beam: protocol/micron/README.md 10. Levels as in recordings (docs/physics.md 2.16): at the nominal gain, a
// wall across the beam 5 m away is at about 55 of 80 dB. At a gain of 28 %, the noise under the ceiling of
// the TVG is at 5 dB; at 58 %, the ring-down is at 24 dB. One ping in six has a burst of interference.
render::SonarSettings micron_acoustics() {
  render::SonarSettings acoustics = single_beam_acoustics(3.0, 35.0);
  acoustics.output_scale = render::OutputScale::half_decibels;
  acoustics.physical.multipath.most_bounces = 6;
  acoustics.physical.pulse.shape = render::PulseSettings::Shape::windowed_chirp;
  acoustics.physical.gain_db = -9.0;
  acoustics.physical.tvg.max_db = 59.0;
  acoustics.physical.noise.level_db = -110.0;
  acoustics.physical.noise.output_db = -77.8;
  acoustics.physical.bin_overlap = 0.55;
  acoustics.physical.noise.by_bearing_db = 7.0;
  acoustics.physical.bearing_jitter_rad = 0.15 * std::numbers::pi / 180.0;
  acoustics.physical.near_field_blank_m = 0.1;
  acoustics.physical.ring_down.level_db = -40.0;
  acoustics.physical.ring_down.vehicle_level_db = -70.0;
  acoustics.physical.noise.interference.probability = 0.16;
  return acoustics;
}

}  // namespace sonard::server
