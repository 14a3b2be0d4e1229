// SPDX-License-Identifier: Apache-2.0
#include "server/devices/oculus/section.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "protocol/oculus/models.hpp"
#include "renderer/acoustics/noise.hpp"
#include "renderer/acoustics/water.hpp"
#include "server/config/status_section.hpp"
#include "server/net/interfaces.hpp"

namespace sonard::server {
namespace {

constexpr double minute_ms = 60'000.0;

void read_identity(YamlSection& section, oculus::DeviceConfig& device) {
  enum class Name : std::uint8_t { m750d, m1200d } name = Name::m750d;
  section.choice("model", name, {{"m750d", Name::m750d}, {"m1200d", Name::m1200d}},
                 "which says frequencies, apertures and ranges");
  device.plan.model = name == Name::m750d ? oculus::m750d : oculus::m1200d;
  section.integer("device_id", device.id, 1, 65535,
                  "unique; clients drop what does not have the ID of the status");
}

void read_network(YamlSection& section, OculusConfig& config) {
  oculus::DeviceConfig& device = config.device;
  section.require("address", "the address that clients connect to");
  config.interface = read_own_address(
      section, "address", device.address,
      "the address that clients find in the status packets and connect to: one of this machine, "
      "or the interface whose address it is, and which is followed when it changes");
  if (section.has("address")) {
    check_host_address(section, "address", device.address);
  }
  section.require("netmask", "the mask of the interface that is served, such as 255.255.255.0");
  config.netmask_interface = read_own_netmask(section, "netmask", device.netmask, "of that interface");
  check_inside_network(section, "address", device.address, device.netmask);
  section.integer("tcp_port", config.tcp_port, 1, 65535, "the head listens here; clients know no other");
  section.integer("status_port", config.status_port, 1, 65535, "status packets go to this port");
  const std::uint16_t id = device.id;
  device.mac = {
      0x00, 0x1E, 0x63, 0x00, static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id & 255U)};
  section.parsed("mac", device.mac, &parse_mac, mac_form, "reported in the status packets");
  section.default_is("mac", "00:1e:63:00 and the device ID");
  read_status_destination(section, "address", device.netmask, config.status);
  read_allow_list(section, device.address, config.allow, "clients that are served");
  warn_of_status_without_access(section, config.status, config.allow);
}

void read_timing(YamlSection& section, oculus::DeviceConfig& device) {
  section.duration("status_period_ms", device.status_period, Range::from(10.0, minute_ms),
                   "from status packet to status packet");
  section.duration("dummy_period_ms", device.dummy_period, Range::from(10.0, minute_ms),
                   "how often a head that does not ping tells its client that it is there");
  section.duration("ping_overhead_ms", device.plan.ping_overhead, Range::above(0.0, 1000.0),
                   "of each ping, beside the time until the last echo is back");
}

void read_firmware(YamlSection& section, oculus::DeviceConfig& device) {
  section.introduce("Where firmware differs, or nobody knows.");
  section.integer("most_ranges", device.plan.most_ranges, 16, 8192,
                  "rows of an image; longer ranges have coarser rows");
  section.boolean("rescales_high_frequency_gain", device.plan.rescales_high_frequency_gain,
                  "reports 40 + 0.6 times the gain at the high frequency: one driver undoes that, and waits "
                  "for it");
  section.boolean("reports_sound_speed_used", device.plan.reports_sound_speed_used,
                  "where a client sends 0 for the speed of sound, reports the one that is used instead");
  section.boolean("reports_version_1", device.plan.reports_version_1,
                  "a ping that answers a fire of version 0 says version 1 in its header; false: version 0");
  section.choice(
      "heading", device.plan.heading_sign, {{"clockwise", 1}, {"counter_clockwise", -1}, {"zero", 0}},
      "how the heading of a ping grows from north, the y axis of the world; `zero`: it is always 0");
  section.choice("pitch", device.plan.pitch_sign, {{"nose_up", 1}, {"nose_down", -1}, {"zero", 0}},
                 "which pitch is positive; `zero`: it is always 0");
  section.choice("roll", device.plan.roll_sign, {{"starboard_down", 1}, {"port_down", -1}, {"zero", 0}},
                 "which roll is positive; `zero`: it is always 0");
  section.choice(
      "pressure", device.plan.surface_pressure_bar,
      {{"absolute", device.plan.surface_pressure_bar}, {"gauge", 0.0}},
      "pressure at the surface: that of the air, 1.013 bar, or 0. It is of the depth below the water "
      "surface of the world; a world without a surface has `water.depth_m`");
  section.text("log_text", device.log_text, "sent to each client that connects; one driver waits for it");
  section.default_is("log_text", "two lines that name sonard");
}

void read_aperture(YamlSection& section, oculus::Mode& mode, OculusModeAcoustics& acoustics) {
  section.number("aperture_deg", mode.horizontal_deg, Range::from(1.0, 170.0),
                 "from the first beam to the last");
  section.number("range_cell_mm", acoustics.range_cell_m, Range::above(0.0, 1000.0),
                 "c / 2B of the chirp: how far apart two echoes are told apart", 1e3);
  section.default_is("aperture_deg", "that of the model");
  section.default_is("range_cell_mm", "that of the model");
}

void read_high_frequency(YamlSection& section, oculus::Mode& mode, OculusModeAcoustics& acoustics) {
  read_aperture(section, mode, acoustics);
  section.angle("vertical_beamwidth_deg", acoustics.vertical_beamwidth_rad, Range::above(0.0, 170.0),
                "-3 dB full width");
  section.angle("receive_beamwidth_deg", acoustics.receive_beamwidth_rad, Range::from(0.1, 60.0),
                "-3 dB width of one beam at broadside");
  section.default_is("vertical_beamwidth_deg", "that of the model");
  section.default_is("receive_beamwidth_deg", "that of the model");
}

void read_oculus_acoustics(YamlSection& section, HeadConfig& head, OculusConfig& config) {
  section.introduce("At the low frequency, and at both where `high_frequency` has no such key.");
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
  section.default_is("vertical_beamwidth_deg", "that of the model");
  section.default_is("receive_beamwidth_deg", "that of the model");
  using Pulse = render::PhysicalModel::Pulse;
  section.choice(
      "pulse", head.acoustics.physical.pulse,
      {{"windowed_chirp", Pulse::windowed_chirp}, {"chirp", Pulse::chirp}, {"point", Pulse::point}},
      "as a matched filter leaves it, under a window or not, or without length");
  section.number("gain_db_per_percent", config.gain_db_per_percent, Range::from(0.0, 10.0),
                 "dB per percent of gain; 50 percent are 0 dB");
  section.section("high_frequency", "what differs at the high frequency",
                  [&](YamlSection& inner) { read_high_frequency(inner, model.modes[1], config.modes[1]); });
}

render::Water water_of(const WaterConfig& water) {
  return {water.temperature_c, water.salinity_ppt, water.depth_m, water.ph};
}

/// What water does at each frequency; `head` has what it does at the low one.
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
      "A Blueprint Subsea Oculus ([protocols/oculus.md](protocols/oculus.md)). The x axis of its mount is "
      "the "
      "acoustic axis, so the down tilt of the head is part of the mount.");
  OculusConfig config;
  read_identity(section, config.device);
  config.modes = oculus_modes(config.device.plan.model);
  apply_water(section, context, config.device.plan.model.modes[0].frequency_hz, head);
  apply_water_to_modes(context, head, config);
  config.device.plan.temperature_c = context.water.temperature_c;
  config.device.plan.water_sound_speed_mps = context.water_sound_speed_mps;
  config.device.waits_for_permission = context.pings_by_source;
  read_common(section, context, head);
  section.require("network", "a mapping with address and netmask");
  section.section("network", "addresses", [&](YamlSection& inner) { read_network(inner, config); });
  section.section("timing", "rates", [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("firmware", "habits of its firmware",
                  [&](YamlSection& inner) { read_firmware(inner, config.device); });
  config.device.plan.pressure_bar = oculus::pressure_bar(context.water.depth_m, config.device.plan);
  section.section("acoustics", "how its image is formed",
                  [&](YamlSection& inner) { read_oculus_acoustics(inner, head, config); });
  return config;
}

}  // namespace sonard::server
