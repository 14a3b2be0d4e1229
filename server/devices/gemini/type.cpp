// SPDX-License-Identifier: Apache-2.0
#include "server/devices/gemini/type.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include <fmt/format.h>

#include "protocol/gemini/bearings.hpp"
#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "protocol/gemini/glf_status.hpp"
#include "protocol/gemini/ping_plan.hpp"
#include "protocol/gemini/ping_settings.hpp"
#include "protocol/gemini/recorded_form.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/connected.hpp"
#include "server/devices/gemini/section.hpp"
#include "server/devices/gemini/settings.hpp"
#include "server/devices/gemini/survey.hpp"
#include "server/logs/log_summary.hpp"
#include "server/net/interfaces.hpp"
#include "server/recording/glf_device.hpp"

namespace sonard::server {
namespace {

constexpr Ipv4 loopback_client = 0x7F000001;
constexpr double bearing_tolerance_rad = 1e-3;

double worst_bearing_error_rad(const LoggedHead& head) {
  const std::vector<double> wire = gemini::bearings_rad();
  double worst = 0.0;
  for (std::size_t i = 0; i < std::min(wire.size(), head.bearings_rad.size()); ++i) {
    worst = std::max(worst, std::abs(head.bearings_rad[i] - wire[i]));
  }
  return worst;
}

class GeminiType final : public DeviceType, public GlfDevice, public CaptureReader {
 public:
  std::string_view name() const override { return "gemini_720i"; }
  std::string_view title() const override { return "Gemini 720i"; }
  bool scanning() const override { return false; }

  // ---- Configuration

  HeadConfig make_default() const override {
    HeadConfig head;
    head.type = this;
    head.device = std::make_shared<GeminiConfig>();
    head.acoustics = gemini_acoustics();
    return head;
  }

  HeadConfig read(YamlSection& section, const HeadContext& context) const override {
    HeadConfig head = make_default();
    head.device = std::make_shared<GeminiConfig>(read_gemini_head(section, context, head));
    return head;
  }

  std::uint16_t device_id(const HeadConfig& head) const override {
    return device_settings<GeminiConfig>(head).device.sonar_id;
  }

  std::vector<PlannedSocket> sockets(const HeadConfig& head) const override {
    using Transport = PlannedSocket::Transport;
    const GeminiConfig& config = device_settings<GeminiConfig>(head);
    std::vector<PlannedSocket> sockets{
        {Transport::udp, {config.bind_address, config.command_port}, "network.bind"}};
    if (config.trigger) {
      sockets.push_back({Transport::udp, *config.trigger, "trigger.bind"});
    }
    return sockets;
  }
  std::string socket_key() const override { return "network.bind"; }

  std::vector<Identity> identities(const HeadConfig& head) const override {
    const gemini::DeviceConfig& device = device_settings<GeminiConfig>(head).device;
    return {{"sonar_id", std::to_string(device.sonar_id)},
            {"network.alternate_address", address_text(device.alternate_address)}};
  }

  std::string summary(const HeadConfig& head) const override {
    const GeminiConfig& config = device_settings<GeminiConfig>(head);
    return fmt::format("ID {}, commands to {}, status {}", config.device.sonar_id,
                       endpoint_text({config.bind_address, config.command_port}),
                       status_text(config.status, config.device.alternate_address, config.device.netmask));
  }

  // Newer clients send nothing to a head if its mask differs from the mask of their own interface.
  std::vector<ConfigWarning> network_warnings(const HeadConfig& head) const override {
    const GeminiConfig& config = device_settings<GeminiConfig>(head);
    const gemini::DeviceConfig& device = config.device;
    const auto owner = owner_of(device.alternate_address, interface_addresses());
    if (owner && owner->netmask != device.netmask) {
      return {{"network.netmask",
               fmt::format("{} is reported, but interface {} has {}: clients that compare them send nothing",
                           address_text(device.netmask), owner->interface, address_text(owner->netmask))}};
    }
    // If the head is bound to this address, trying the socket has already reported it.
    if (!owner && config.bind_address != device.alternate_address) {
      return {{"network.alternate_address",
               fmt::format("{} is not an address of this machine, but clients send commands to it",
                           address_text(device.alternate_address))}};
    }
    return {};
  }

  // ---- Serving

  std::vector<Counter> counters() const override {
    gemini::DeviceConfig any;
    any.alternate_address = loopback_client;
    return gemini::Device(any, {}).counts();
  }

  std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                           const Clock& clock) const override {
    return connect_gemini(head, io, clock);
  }

  PingJob usual_job(const HeadConfig& head) const override {
    // Every output of make_ping_config() is valid for plan_ping().
    return gemini::plan_ping(gemini::make_ping_config({}), device_settings<GeminiConfig>(head).device)
        .value()
        .job;
  }

  render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const override {
    return gemini_sonar_settings(job, head);
  }

  // ---- Logs

  std::optional<glf::StatusRecord> glf_status(std::span<const std::uint8_t> message) const override {
    const auto report = gemini::decode_report(message);
    const auto* const status = report ? std::get_if<gemini::Status>(&*report) : nullptr;
    return status != nullptr ? std::optional(gemini::glf_status(*status)) : std::nullopt;
  }

  std::optional<CapturedPing> ping_in(std::span<const std::uint8_t> datagram) const override {
    constexpr std::uint16_t resent_head_bit = 0x0100;  // of PingHead::ping_id
    const auto report = gemini::decode_report(datagram);
    const auto* const head = report ? std::get_if<gemini::PingHead>(&*report) : nullptr;
    if (head == nullptr || (head->ping_id & resent_head_bit) != 0) {
      return std::nullopt;
    }
    CapturedPing seen{std::string(name()), head->header.sonar_id, gemini::settings_of(*head)};
    seen.settings.frequency_hz = 0.0;  // not on the wire
    return seen;
  }

  // ---- Playing logs back

  std::optional<std::string> why_not_played(const LoggedHead& logged) const override {
    for (const LoggedPing& ping : logged.pings) {
      if (!gemini::recorded_form(ping.settings)) {
        return fmt::format(
            "sonar {} has an image of {} range bins of {} beams, which a Gemini 720i cannot send "
            "(expected {} beams)",
            logged.device_id, ping.settings.bins, ping.settings.beams, gemini::beam_count);
      }
    }
    return std::nullopt;
  }

  std::vector<std::string> played_wrongly(const LoggedHead& logged) const override {
    std::vector<std::string> problems;
    const auto inexact = std::ranges::count_if(
        logged.pings, [](const LoggedPing& ping) { return !gemini::recorded_form(ping.settings)->exact; });
    if (inexact > 0) {
      problems.push_back(fmt::format(
          "{} of {} images have lines of a length that a 720i does not have: clients will show wrong ranges",
          inexact, logged.pings.size()));
    }
    if (const double worst_rad = worst_bearing_error_rad(logged); worst_rad > bearing_tolerance_rad) {
      problems.push_back(
          fmt::format("bearings of the recording differ by up to {:.1f} degrees from a 720i: clients will "
                      "show wrong bearings",
                      worst_rad * 180.0 / std::numbers::pi));
    }
    return problems;
  }

  HeadConfig on_loopback(const LoggedHead& logged, Ipv4 address) const override {
    HeadConfig head = make_default();
    auto config = std::make_shared<GeminiConfig>();
    const std::uint16_t id = std::max(logged.device_id, gemini::min_sonar_id);
    config->device.sonar_id = id;
    config->device.mac = {
        0x00, 0x12, 0x34, 0x00, static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id & 0xFF)};
    config->device.alternate_address = address;
    config->device.netmask = 0xFF000000;
    config->bind_address = address;
    config->status = {StatusDestination::Mode::unicast, {loopback_client}};
    config->allow = {{0x7F000000, 8}};
    head.device = std::move(config);
    head.name = logged.name.empty() ? fmt::format("gemini-{}", logged.device_id) : logged.name;
    return head;
  }

  HeadConfig held_to_recording(HeadConfig head) const override {
    auto config = std::make_shared<GeminiConfig>(device_settings<GeminiConfig>(head));
    config->device.plays_back = true;
    config->device.simulated_time = false;
    config->device.min_ping_period = std::chrono::milliseconds{1};
    config->device.render_lead = {};
    head.device = std::move(config);
    return head;
  }

  std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const override {
    return survey_of_gemini(head, options);
  }
};

}  // namespace

const DeviceType& gemini_type() {
  static const GeminiType type;
  return type;
}

// Leakage and noise as in recordings (docs/physics.md 2.16).
render::SonarSettings gemini_acoustics() {
  constexpr double degree = std::numbers::pi / 180.0;
  render::SonarSettings acoustics;
  acoustics.aperture.azimuth = render::Aperture::Azimuth::array;
  acoustics.aperture.element_amplitude_sd = 0.12;
  acoustics.aperture.element_phase_sd_rad = 7 * degree;
  acoustics.physical.multipath.most_bounces = 6;
  acoustics.physical.pulse.shape = render::PulseSettings::Shape::tone;
  acoustics.physical.noise.cell_m = 0.0096;  // 78 kHz, of lines sampled at 90 kHz
  acoustics.physical.tvg.log_coefficient = 40.0;
  acoustics.physical.tvg.max_db = 78.0;
  acoustics.physical.pulse.tone_rounding_m = 0.018;  // 42 kHz: a Q of 17
  acoustics.physical.gain_db = 31.0;
  acoustics.physical.noise.level_db = -132.0;
  acoustics.physical.noise.output_db = -46.0;
  acoustics.physical.speckle.texture_nu = 15.0;
  acoustics.physical.water_clutter.density_per_m3 = 0.1;
  // It is not published whether transmitter and receiver have the same height, so the pattern applies once
  // (docs/physics.md 2.5).
  acoustics.aperture.elevation = render::Aperture::Elevation::sinc;
  return acoustics;
}

}  // namespace sonard::server
