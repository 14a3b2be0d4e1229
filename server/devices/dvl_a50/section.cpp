// SPDX-License-Identifier: Apache-2.0
#include "server/devices/dvl_a50/section.hpp"

#include <string>

#include "server/yaml/network_section.hpp"

namespace sonard::server {
namespace {

using dvl_a50::Release;

constexpr double minute_ms = 60'000.0;
constexpr TextForm range_mode_form{"auto, =a, a<=b or wt with a and b from 0 to 4", "range mode",
                                   R"("type": "string", "pattern": "^(auto|=[0-4]|[0-4]<=[0-4]|wt)$")"};

std::optional<std::string> parse_range_mode(std::string_view text) {
  return dvl_a50::parse_range_mode(text) ? std::optional<std::string>(text) : std::nullopt;
}

TcpTransportConfig read_tcp(YamlSection& inner, std::string_view meaning) {
  TcpTransportConfig tcp;
  read_socket(inner, tcp.bind, tcp.allow, endpoint_form, meaning, "address blocks of clients");
  return tcp;
}

void read_sockets(YamlSection& section, const HeadContext& context, DvlConfig& config) {
  section.require("tcp", "clients connect to it; port 16171 on a real device");
  section.section("tcp", "JSON reports and commands", [&](YamlSection& inner) {
    config.json = read_tcp(inner, "TCP address; a real device has port 16171");
  });
  int channels = 1;
  const auto read = [&](std::string_view key, std::string_view meaning, std::string_view port,
                        std::optional<TcpTransportConfig>& tcp, int& channel) {
    section.section(key, meaning, [&](YamlSection& inner) { tcp = read_tcp(inner, port); });
    channel = section.has(key) ? channels++ : -1;
  };
  dvl_a50::DeviceConfig& device = config.device;
  read("pd6", "PD6 text lines, if given", "TCP address; a real device has port 1037", config.pd6,
       device.pd6_channel);
  read("pd4", "PD4 packets, if given", "TCP address; a real device has port 1038", config.pd4,
       device.pd4_channel);
  read("http", "the pages by which vehicle software finds the device, if given",
       "TCP address; a real device has port 80", config.http, device.http_channel);
  section.section("serial", "serial line, if given",
                  [&](YamlSection& inner) { config.serial = read_serial_link(inner, context.folder); });
  device.serial_channel = section.has("serial") ? channels : -1;
}

void read_initial(YamlSection& section, dvl_a50::Settings& settings) {
  section.number("speed_of_sound_mps", settings.speed_of_sound_mps, Range::from(1000.0, 2000.0),
                 "speed that the device assumes; distances and velocities scale with it");
  section.boolean("acoustic_enabled", settings.acoustic_enabled, "false: only triggered pings");
  section.boolean("dark_mode_enabled", settings.dark_mode_enabled, "true: the LED is off");
  section.number("mounting_rotation_offset_deg", settings.mounting_rotation_offset_deg,
                 Range::from(0.0, 360.0),
                 "clockwise angle from the vehicle's forward axis to that of the device");
  section.parsed("range_mode", settings.range_mode, &parse_range_mode, range_mode_form,
                 "range modes in which the device looks for the bottom; `wt`: water tracking");
  section.boolean(
      "periodic_cycling_enabled", settings.periodic_cycling_enabled,
      "true: every `cycling_interval_ms` the device looks for a nearer bottom and leaves out a report");
}

void read_device(YamlSection& section, dvl_a50::DeviceConfig& device) {
  section.choice("release", device.release,
                 {{"2.7.2", Release::v2_7_2},
                  {"2.7.1", Release::v2_7_1},
                  {"2.6.1", Release::v2_6_1},
                  {"2.4.0", Release::v2_4_0},
                  {"2.2.1", Release::v2_2_1},
                  {"2.1.0", Release::v2_1_0}},
                 "release of the firmware; it sets commands and the text of `format`");
  section.choice("line_end", device.line_end, {{"crlf", std::string("\r\n")}, {"lf", std::string("\n")}},
                 "end of each JSON message");
  section.text("product_name", device.product_name, "name that clients find");
  section.default_is("product_name", "set by `model`");
  section.text("chip_id", device.chip_id, "ID that the device reports");
  section.number("device_temperature_c", device.temperature_c, Range::from(-10.0, 100.0),
                 "temperature of the device; from 55 on it reports that it is hot");
  section.boolean("ntp_synced", device.ntp_synced, "true: a time server sets the clock of the device");
  section.number("beam_noise_mps", device.beam_noise_mps, Range::from(0.0, 1.0),
                 "standard deviation of a beam's velocity at rest");
  section.number("beam_noise_factor", device.beam_noise_factor, Range::from(0.0, 1.0),
                 "share of the speed that is added to `beam_noise_mps`");
  section.number("altitude_offset_m", device.altitude_offset_m, Range::from(-1.0, 1.0),
                 "added to the altitude");
  section.number("heading_drift_deg_per_min", device.heading_drift_deg_per_min, Range::from(-60.0, 60.0),
                 "drift of the yaw of dead reckoning");
  section.number(
      "position_noise_m", device.position_noise_m, Range::from(0.0, 10.0),
      "growth of the error of dead reckoning while the vehicle moves, per root second; ten times as "
      "much without bottom lock");
  glm::dvec3 current_mps{0.0};
  section.vector3("water_current_mps", current_mps, Range::from(-10.0, 10.0),
                  "motion of the water (east, north, up), for water tracking");
  device.water_current_mps = {current_mps.x, current_mps.y, current_mps.z};
  section.integer("seed", device.seed, 0, 4'294'967'295U, "seed of the noise of velocities and positions");
}

void read_timing(YamlSection& section, dvl_a50::DeviceConfig& device) {
  section.number(
      "scale", device.time_scale, Range::from(0.0, 100.0),
      "factor on the time from ping to ping and of a calibration; 0: as fast as pings are rendered");
  section.duration("search_interval_ms", device.search_interval, Range::from(10.0, minute_ms),
                   "time between reports without bottom lock");
  section.duration("cycling_interval_ms", device.cycling_interval, Range::from(100.0, 60.0 * minute_ms),
                   "time between the reports that periodic cycling leaves out");
  section.duration("processing_delay_ms", device.processing_delay, Range::from(0.0, 10'000.0),
                   "from the reflection of a ping to its report");
  section.duration("calibration_ms", device.calibration_time, Range::from(0.0, minute_ms),
                   "time until calibrate_gyro is answered");
}

}  // namespace

DvlConfig read_dvl_head(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  section.introduce(
      "A Water Linked DVL A50 or A125 ([protocol](../protocol/dvl_a50/README.md)). It looks along the x axis "
      "of its "
      "mount, forward along the z axis: `rpy_deg: [0, 90, 0]` looks down.");
  dvl_a50::Model model = dvl_a50::Model::a50;
  section.choice("model", model, {{"a50", dvl_a50::Model::a50}, {"a125", dvl_a50::Model::a125}},
                 "model of the device; it sets beams, frequency, greatest altitude and speed, and name");
  DvlConfig config;
  config.device = dvl_a50::DeviceConfig(model);
  head.acoustics = dvl_acoustics(model);
  apply_water(section, context, dvl_carrier_hz(model), head);
  config.device.simulated_time = context.simulated_time;
  if (context.water_sound_speed_mps > 0.0) {
    config.device.water_sound_speed_mps = context.water_sound_speed_mps;
  }
  read_common(section, context, head);
  read_sockets(section, context, config);
  section.section("initial", "what set_config sets, at power up",
                  [&](YamlSection& inner) { read_initial(inner, config.device.settings); });
  section.section("device", "identity, noise and errors",
                  [&](YamlSection& inner) { read_device(inner, config.device); });
  if (config.device.release < Release::v2_7_1 && config.device.settings.range_mode == "wt") {
    section.report("device", "has no range mode wt (expected release 2.7.1 or newer)");
  }
  section.section("timing", "pace of pings and reports",
                  [&](YamlSection& inner) { read_timing(inner, config.device); });
  return config;
}

}  // namespace sonard::server
