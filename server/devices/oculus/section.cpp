// SPDX-License-Identifier: Apache-2.0
#include "server/devices/oculus/section.hpp"

#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "protocol/oculus/models.hpp"
#include "renderer/acoustics/noise.hpp"
#include "renderer/acoustics/water.hpp"
#include "server/net/interfaces.hpp"
#include "server/yaml/status_section.hpp"

namespace sonard::server {
namespace {

constexpr double minute_ms = 60'000.0;

void read_identity(YamlSection& section, oculus::DeviceConfig& device) {
  std::vector<std::pair<std::string_view, std::size_t>> names;
  for (const oculus::Model& model : oculus::models) {
    names.emplace_back(model.name, names.size());
  }
  std::size_t chosen = 0;
  section.choice("model", chosen, names, "model of the device; it sets frequencies, apertures and ranges");
  device.plan.model = oculus::models[chosen];
  section.integer("device_id", device.id, 1, 65535,
                  "unique ID of the head; clients drop messages without the ID of the status packets");
}

void read_network(YamlSection& section, OculusConfig& config) {
  oculus::DeviceConfig& device = config.device;
  section.require("address", "the address that clients connect to");
  config.interface =
      read_own_address(section, "address", device.address,
                       "address that clients find in the status packets and connect to, or the interface "
                       "with this address. If the address of the interface changes, the head follows it");
  if (section.has("address")) {
    check_host_address(section, "address", device.address);
  }
  section.require("netmask", "the mask of the interface that is served, such as 255.255.255.0");
  config.netmask_interface =
      read_own_netmask(section, "netmask", device.netmask, "netmask of that interface");
  check_inside_network(section, "address", device.address, device.netmask);
  section.integer("tcp_port", config.tcp_port, 1, 65535,
                  "TCP port of the head; clients have the default built in");
  section.integer("status_port", config.status_port, 1, 65535, "destination port of the status packets");
  const std::uint16_t id = device.id;
  device.mac = {
      0x00, 0x1E, 0x63, 0x00, static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id & 255U)};
  section.parsed("mac", device.mac, &parse_mac, mac_form, "MAC address in the status packets");
  section.default_is("mac", "00:1e:63:00 and the device ID");
  read_status_destination(section, "address", device.netmask, config.status);
  read_allow_list(section, device.address, config.allow, "address blocks of clients that the head serves");
  warn_of_status_without_access(section, config.status, config.allow);
}

void read_timing(YamlSection& section, oculus::DeviceConfig& device) {
  section.duration("status_period_ms", device.status_period, Range::from(10.0, minute_ms),
                   "period of the status packets");
  section.duration("dummy_period_ms", device.dummy_period, Range::from(10.0, minute_ms),
                   "period of the Dummy messages while the head does not ping");
  section.duration("ping_overhead_ms", device.plan.ping_overhead, Range::above(0.0, 1000.0),
                   "overhead of each ping, beside the time until the last echo");
}

void read_firmware(YamlSection& section, oculus::DeviceConfig& device) {
  section.introduce("Behaviour that differs between firmware versions, or is unknown.");
  section.integer("most_ranges", device.plan.most_ranges, 16, 8192,
                  "maximum number of rows in an image; longer ranges have coarser rows");
  section.boolean("rescales_high_frequency_gain", device.plan.rescales_high_frequency_gain,
                  "true: at the high frequency the head reports 40 + 0.6 times the gain; one driver waits "
                  "for this value");
  section.boolean("reports_sound_speed_used", device.plan.reports_sound_speed_used,
                  "true: for a commanded 0, the head reports the sound speed that it used");
  section.boolean("reports_version_1", device.plan.reports_version_1,
                  "version of a ping that answers a fire of version 0: 1 (true) or 0 (false)");
  section.choice("heading", device.plan.heading_sign,
                 {{"clockwise", 1}, {"counter_clockwise", -1}, {"zero", 0}},
                 "direction of growth from north (y); `zero`: 0");
  section.choice("pitch", device.plan.pitch_sign, {{"nose_up", 1}, {"nose_down", -1}, {"zero", 0}},
                 "positive direction of the pitch; `zero`: always 0");
  section.choice("roll", device.plan.roll_sign, {{"starboard_down", 1}, {"port_down", -1}, {"zero", 0}},
                 "positive direction of the roll; `zero`: always 0");
  section.choice("pressure", device.plan.surface_pressure_bar,
                 {{"absolute", device.plan.surface_pressure_bar}, {"gauge", 0.0}},
                 "reported pressure at the surface: `absolute` is the air pressure, 1.013 bar; `gauge` is 0. "
                 "It includes the depth below the water surface of the world, or else `water.depth_m`");
  section.text("log_text", device.log_text,
               "text sent to each client that connects; one driver waits for it");
  section.default_is("log_text", "two lines that name sonard");
}

void read_aperture(YamlSection& section, oculus::Mode& mode, OculusModeAcoustics& acoustics) {
  section.number("aperture_deg", mode.horizontal_deg, Range::from(1.0, 170.0),
                 "angle from the first beam to the last");
  section.number("range_cell_mm", acoustics.range_cell_m, Range::above(0.0, 1000.0),
                 "range resolution, c / 2B of the chirp", 1e3);
  section.default_is("aperture_deg", "set by `model`");
  section.default_is("range_cell_mm", "set by `model`");
}

constexpr double absorption_of_water = -1.0;

/// @param absorption_db_per_km may be absorption_of_water
void read_high_frequency(YamlSection& section, oculus::Mode& mode, OculusModeAcoustics& acoustics,
                         double& absorption_db_per_km) {
  section.number_or_word("absorption_db_per_km", absorption_db_per_km, Range::from(0.0, 10'000.0),
                         {{"of_water", absorption_of_water}}, "one-way absorption at the high frequency");
  read_aperture(section, mode, acoustics);
  section.angle("vertical_beamwidth_deg", acoustics.vertical_beamwidth_rad, Range::above(0.0, 170.0),
                "-3 dB full width");
  section.angle("receive_beamwidth_deg", acoustics.receive_beamwidth_rad, Range::from(0.1, 60.0),
                "-3 dB width of one beam at broadside");
  section.default_is("vertical_beamwidth_deg", "set by `model`");
  section.default_is("receive_beamwidth_deg", "set by `model`");
}

void read_oculus_acoustics(YamlSection& section, HeadConfig& head, OculusConfig& config,
                           double& high_absorption_db_per_km) {
  section.introduce(
      "These keys apply to the low frequency. They also apply to the high frequency unless `high_frequency` "
      "has the key.");
  oculus::Model& model = config.device.plan.model;
  OculusModeAcoustics& low = config.modes[0];
  render::Aperture& aperture = head.acoustics.aperture;
  aperture.vertical_beamwidth_rad = low.vertical_beamwidth_rad;
  aperture.receive_beamwidth_rad = low.receive_beamwidth_rad;
  read_acoustics(section, model.modes[0].frequency_hz, head);
  read_receive_array(section, aperture);
  low.vertical_beamwidth_rad = aperture.vertical_beamwidth_rad;
  low.receive_beamwidth_rad = aperture.receive_beamwidth_rad;
  read_aperture(section, model.modes[0], low);
  section.default_is("vertical_beamwidth_deg", "set by `model`");
  section.default_is("receive_beamwidth_deg", "set by `model`");
  using Shape = render::PulseSettings::Shape;
  section.choice(
      "pulse", head.acoustics.physical.pulse.shape,
      {{"windowed_chirp", Shape::windowed_chirp}, {"chirp", Shape::chirp}, {"point", Shape::point}},
      "matched filter, windowed or not, or a `point`");
  section.number("gain_db_per_percent", config.gain_db_per_percent, Range::from(0.0, 10.0),
                 "dB per percent of gain; 50 percent is 0 dB");
  section.section("high_frequency", "values that differ at the high frequency", [&](YamlSection& inner) {
    read_high_frequency(inner, model.modes[1], config.modes[1], high_absorption_db_per_km);
  });
  if (section.has("high_frequency") && !model.has_high_frequency()) {
    section.report("high_frequency",
                   fmt::format("model {} has one frequency (expected no value)", model.name));
  }
}

render::Water water_of(const WaterConfig& water) {
  return {water.temperature_c, water.salinity_ppt, water.depth_m, water.ph};
}

/// Sets the effects of water at each frequency; `head` holds the values of the low one.
void apply_water_to_modes(const HeadContext& context, const HeadConfig& head, OculusConfig& config) {
  const oculus::Model& model = config.device.plan.model;
  const render::Water water = water_of(context.water);
  for (std::size_t i = 0; i < config.modes.size(); ++i) {
    const double frequency_hz = model.modes[i].frequency_hz;
    OculusModeAcoustics& mode = config.modes[i];
    mode.absorption_db_per_m = i == 0 || context.absorption_db_per_m >= 0.0
                                   ? head.acoustics.physical.absorption_db_per_m
                                   : render::francois_garrison_absorption_db_per_m(frequency_hz, water);
    mode.wavelength_m = render::sound_speed_mps(water) / frequency_hz;
  }
}

}  // namespace

OculusConfig read_oculus_head(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  section.introduce(
      "A Blueprint Subsea Oculus ([messages](../protocol/oculus/README.md)). The x axis of its mount is "
      "the acoustic axis, so the mount includes the down tilt of the head.");
  OculusConfig config;
  read_identity(section, config.device);
  config.modes = oculus_modes(config.device.plan.model);
  apply_water(section, context, config.device.plan.model.modes[0].frequency_hz, head);
  apply_water_to_modes(context, head, config);
  config.device.plan.temperature_c = context.water.temperature_c;
  config.device.plan.water_sound_speed_mps = context.water_sound_speed_mps;
  config.device.simulated_time = context.simulated_time;
  read_common(section, context, head);
  section.require("network", "a mapping with address and netmask");
  section.section("network", "addresses and ports", [&](YamlSection& inner) { read_network(inner, config); });
  section.section("timing", "rates", [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("firmware", "behaviour of the firmware",
                  [&](YamlSection& inner) { read_firmware(inner, config.device); });
  config.device.plan.pressure_bar = oculus::pressure_bar(context.water.depth_m, config.device.plan);
  double high_absorption_db_per_km = absorption_of_water;
  section.section("acoustics", "formation of the image", [&](YamlSection& inner) {
    read_oculus_acoustics(inner, head, config, high_absorption_db_per_km);
  });
  if (high_absorption_db_per_km >= 0.0) {
    config.modes[1].absorption_db_per_m = high_absorption_db_per_km / 1000.0;
  } else if (context.absorption_db_per_m < 0.0) {
    warn_of_absorption(section, context.water, config.device.plan.model.modes[1].frequency_hz,
                       "heads[].acoustics.high_frequency.absorption_db_per_km");
  }
  return config;
}

}  // namespace sonard::server
