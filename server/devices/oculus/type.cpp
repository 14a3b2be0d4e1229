// SPDX-License-Identifier: Apache-2.0
#include "server/devices/oculus/type.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "protocol/oculus/device.hpp"
#include "protocol/oculus/recorded_form.hpp"
#include "renderer/acoustics/noise.hpp"
#include "renderer/acoustics/water.hpp"
#include "server/devices/oculus/config.hpp"
#include "server/devices/oculus/connected.hpp"
#include "server/devices/oculus/section.hpp"
#include "server/devices/oculus/settings.hpp"
#include "server/devices/oculus/survey.hpp"
#include "server/net/interfaces.hpp"

namespace sonard::server {
namespace {

constexpr Ipv4 loopback_client = 0x7F000001;
constexpr double degree = std::numbers::pi / 180.0;

class OculusType final : public DeviceType {
 public:
  std::string_view name() const override { return "oculus"; }
  std::string_view title() const override { return "Oculus"; }
  std::vector<std::string_view> models() const override {
    std::vector<std::string_view> names;
    for (const oculus::Model& model : oculus::models) {
      names.push_back(model.name);
    }
    return names;
  }
  bool scanning() const override { return false; }
  bool has_sensors() const override { return true; }

  // ---- Configuration

  HeadConfig make_default() const override {
    HeadConfig head;
    head.type = this;
    auto config = std::make_shared<OculusConfig>();
    config->modes = oculus_modes(config->device.plan.model);
    head.device = std::move(config);
    head.acoustics = oculus_acoustics();
    return head;
  }

  HeadConfig read(YamlSection& section, const HeadContext& context) const override {
    HeadConfig head = make_default();
    head.device = std::make_shared<OculusConfig>(read_oculus_head(section, context, head));
    return head;
  }

  std::uint16_t device_id(const HeadConfig& head) const override {
    return device_settings<OculusConfig>(head).device.id;
  }

  std::vector<PlannedSocket> sockets(const HeadConfig& head) const override {
    const OculusConfig& config = device_settings<OculusConfig>(head);
    return {{PlannedSocket::Transport::tcp, {config.device.address, config.tcp_port}, "network.address"}};
  }
  std::string socket_key() const override { return "network.address"; }

  std::vector<Identity> identities(const HeadConfig& head) const override {
    const oculus::DeviceConfig& device = device_settings<OculusConfig>(head).device;
    return {{"device_id", std::to_string(device.id)}, {"network.address", address_text(device.address)}};
  }

  std::string summary(const HeadConfig& head) const override {
    const OculusConfig& config = device_settings<OculusConfig>(head);
    const oculus::DeviceConfig& device = config.device;
    return fmt::format("ID {}, part {}, TCP {}, status {}, port {}", device.id, device.plan.model.part_number,
                       endpoint_text({device.address, config.tcp_port}),
                       status_text(config.status, device.address, device.netmask), config.status_port);
  }

  // ---- Serving

  std::vector<Counter> counters() const override { return oculus::Device({}, {}).counts(); }

  std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                           const Clock& clock) const override {
    return connect_oculus(head, io, clock);
  }

  PingJob usual_job(const HeadConfig& head) const override {
    oculus::SimpleFire fire;
    fire.fire.master_mode = 1;
    fire.fire.range = 20.0;
    fire.fire.sound_speed_mps = 1500.0;
    fire.fire.flags |= oculus::fire_flags::beams_512;
    const oculus::PlanConfig& plan = device_settings<OculusConfig>(head).device.plan;
    return oculus::job_of(oculus::plan_ping(fire, plan), plan);
  }

  render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const override {
    return oculus_sonar_settings(job, head);
  }

  // ---- Playing logs back

  std::optional<std::string> why_not_played(const LoggedHead& logged) const override {
    const auto told = [](const LoggedPing& ping) { return oculus::recorded_form(ping.wire).has_value(); };
    if (!std::ranges::all_of(logged.pings, told)) {
      return fmt::format("pings of device {} lack their wire format (expected wire_head)", logged.device_id);
    }
    return std::nullopt;
  }

  HeadConfig on_loopback(const LoggedHead& logged, Ipv4 address) const override {
    HeadConfig head = make_default();
    auto config = std::make_shared<OculusConfig>(device_settings<OculusConfig>(head));
    config->device.id = std::max<std::uint16_t>(logged.device_id, 1);
    config->device.address = address;
    config->device.netmask = 0xFF000000;
    config->status = {StatusDestination::Mode::unicast, {loopback_client}};
    config->allow = {{0x7F000000, 8}};
    head.device = std::move(config);
    head.name = logged.name.empty() ? fmt::format("oculus-{}", logged.device_id) : logged.name;
    return head;
  }

  HeadConfig held_to_recording(HeadConfig head) const override {
    auto config = std::make_shared<OculusConfig>(device_settings<OculusConfig>(head));
    config->device.plays_back = true;
    config->device.simulated_time = false;
    head.device = std::move(config);
    return head;
  }

  std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const override {
    return survey_of_oculus(head, options);
  }
};

}  // namespace

const DeviceType& oculus_type() {
  static const OculusType type;
  return type;
}

// Levels of the other multibeam head, at nearly the same frequency: recordings of both show the same ratio of
// noise to echoes.
render::SonarSettings oculus_acoustics() {
  render::SonarSettings acoustics;
  acoustics.aperture.azimuth = render::Aperture::Azimuth::array;
  acoustics.aperture.fine_beams = 1;  // beams are spaced closer than their resolution
  acoustics.aperture.element_amplitude_sd = 0.12;
  acoustics.aperture.element_phase_sd_rad = 7 * degree;
  acoustics.aperture.elevation = render::Aperture::Elevation::sinc;
  acoustics.physical.multipath.most_bounces = 6;
  acoustics.physical.pulse.shape = render::PulseSettings::Shape::windowed_chirp;
  acoustics.physical.tvg.log_coefficient = 40.0;
  acoustics.physical.tvg.max_db = 78.0;
  acoustics.physical.gain_db = 31.0;
  acoustics.physical.noise.level_db = -132.5;
  acoustics.physical.noise.output_db = -46.0;
  acoustics.physical.speckle.texture_nu = 15.0;
  acoustics.physical.water_clutter.density_per_m3 = 0.1;
  acoustics.physical.near_field_blank_m = oculus::least_range_m;
  return acoustics;
}

std::array<OculusModeAcoustics, 2> oculus_modes(const oculus::Model& model) {
  const render::Water water;
  std::array<OculusModeAcoustics, 2> modes;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const oculus::Mode& of_model = model.modes[i];
    modes[i].vertical_beamwidth_rad = of_model.vertical_deg * degree;
    modes[i].receive_beamwidth_rad = of_model.resolution_deg * degree;
    modes[i].range_cell_m = of_model.range_cell_m;
    modes[i].absorption_db_per_m =
        render::francois_garrison_absorption_db_per_m(of_model.frequency_hz, water);
    modes[i].wavelength_m = render::sound_speed_mps(water) / of_model.frequency_hz;
    modes[i].noise_db = render::thermal_noise_db(of_model.frequency_hz) -
                        render::thermal_noise_db(model.modes[0].frequency_hz);
  }
  return modes;
}

}  // namespace sonard::server
