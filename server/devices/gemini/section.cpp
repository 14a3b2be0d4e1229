// SPDX-License-Identifier: Apache-2.0
#include "server/devices/gemini/section.hpp"

#include <fmt/format.h>

#include "protocol/gemini/messages.hpp"
#include "server/net/addresses.hpp"
#include "server/net/interfaces.hpp"
#include "server/yaml/network_section.hpp"
#include "server/yaml/status_section.hpp"

namespace sonard::server {
namespace {

constexpr double minute_ms = 60'000.0;
constexpr TextForm bind_form{"an address of this machine, or 0.0.0.0 for all of them", "address",
                             address_schema, true};
constexpr TextForm trigger_form{"an address and port such as 127.0.0.1:14700", endpoint_form.type,
                                endpoint_form.schema, true};

void read_identity(YamlSection& section, GeminiConfig& config) {
  // 0 means "not set" and 1 is reserved for production: clients send nothing to either ID
  // (protocol/gemini/README.md 1.4).
  section.require("sonar_id", "a whole number from 2 to 65535");
  section.integer("sonar_id", config.device.sonar_id, 2, 65535,
                  "unique ID of the head; clients never send to 0 and 1");
}

void read_network(YamlSection& section, GeminiConfig& config) {
  gemini::DeviceConfig& device = config.device;
  section.require("alternate_address", "the address that clients find in the status packets");
  config.interface =
      read_own_address(section, "alternate_address", device.alternate_address,
                       "address that clients find in the status packets and send to, or the interface with "
                       "this address. If the address of the interface changes, the head follows it");
  if (section.has("alternate_address")) {
    check_host_address(section, "alternate_address", device.alternate_address);
  }
  section.require("netmask", "the mask of the interface that is served, such as 255.255.255.0");
  config.netmask_interface = read_own_netmask(section, "netmask", device.netmask,
                                              "true mask of the interface; some clients ignore other masks");
  check_inside_network(section, "alternate_address", device.alternate_address, device.netmask);
  const std::string fixed_address = address_text(device.fixed_address);
  section.parsed("fixed_address", device.fixed_address, &parse_ipv4, address_form,
                 "hard-wired address, in the status; also served if `bind` is 0.0.0.0");
  section.default_is("fixed_address", fixed_address, '"' + fixed_address + '"');
  check_host_address(section, "fixed_address", device.fixed_address);

  config.bind_address = device.alternate_address;
  section.place_default("bind", "alternate_address");
  section.parsed("bind", config.bind_address, &parse_ipv4, bind_form,
                 "address of the command socket; 0.0.0.0 is all addresses of this machine");
  section.default_is("bind", "the alternate address");
  if (config.bind_address != 0 && config.bind_address != device.alternate_address) {
    section.warn("bind",
                 fmt::format("clients send to the alternate address {}, but the head listens only on {}",
                             address_text(device.alternate_address), address_text(config.bind_address)));
  }
  section.integer("command_port", config.command_port, 1, 65535,
                  "port that receives commands and sends replies");
  section.renamed("surface_port", "client_port");
  section.integer("client_port", device.client_port, 1, 65535,
                  "destination port of all replies and status packets");

  const std::uint16_t id = device.sonar_id;
  device.mac = {
      0x00, 0x12, 0x34, 0x00, static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id & 255U)};
  section.parsed("mac", device.mac, &parse_mac, mac_form, "MAC address in the status packets");
  section.default_is("mac", "00:12:34:00 and the sonar ID");
  section.boolean("accept_id_zero", device.accept_id_zero,
                  "true: the head also accepts commands with the header ID 0");

  read_status_destination(section, "alternate_address", device.netmask, config.status);
  read_allow_list(section, config.bind_address, config.allow,
                  "address blocks of clients that the head serves");
  warn_of_status_without_access(section, config.status, config.allow);
}

void read_timing(YamlSection& section, gemini::DeviceConfig& device) {
  section.duration("status_period_ms", device.status_period, Range::from(10.0, minute_ms),
                   "period of the status packets");
  section.duration("min_ping_period_ms", device.min_ping_period, Range::from(1.0, minute_ms),
                   "shortest time from ping to ping, whatever the client requests");
  section.renamed("surface_timeout_ms", "client_timeout_ms");
  section.duration("client_timeout_ms", device.client_timeout, Range::from(10.0, 3600.0 * 1000.0),
                   "silence after which the head drops its client and suspends pinging");
  section.duration("reboot_time_ms", device.reboot_time, Range::from(0.0, minute_ms),
                   "silence after a reboot command");
  section.duration("line_period_us", device.line_period, Range::from(1.0, 10'000.0),
                   "minimum mean time between ping datagrams; default: as at 100 Mbit/s");
  section.integer("burst_lines", device.burst_lines, 1, 1024,
                  "maximum number of ping datagrams sent back to back");
  section.duration("retry_hold_ms", device.retry_hold, Range::from(0.0, 10'000.0),
                   "time that a new ping waits after the last request to send lines again");
  section.duration("retry_hold_max_ms", device.retry_hold_max, Range::from(0.0, 10'000.0),
                   "maximum of the wait by `retry_hold_ms`");
  if (device.retry_hold_max < device.retry_hold) {
    section.report("retry_hold_max_ms", "is shorter than retry_hold_ms (expected at least as long)");
  }
  section.duration("render_lead_ms", device.render_lead, Range::from(0.0, 1000.0),
                   "how long before its transmit time a ping may be rendered. More raises the ping rate of a "
                   "slow renderer; the pose is then extrapolated by this time");
}

void read_gain_law(YamlSection& section, gemini::GainLaw& law) {
  section.introduce("It is inferred from the values that clients send.");
  section.number("reference_spreading", law.reference_spreading, Range::above(0.0, 1023.0),
                 "`spreading` of 0 dB; 50 percent is 67 (early clients) or 213");
  section.number("db_per_percent", law.db_per_percent, Range::from(0.0, 10.0),
                 "dB per percent of gain, with the percentages of early clients");
  section.number("nominal_main_gain_db", law.nominal_main_gain_db, Range::from(0.0, 100.0),
                 "main gain at which the level is 0 dB");
}

void read_gemini_acoustics(YamlSection& section, HeadConfig& head, GeminiConfig& config) {
  read_acoustics(section, gemini::carrier_hz, head);
  read_receive_array(section, head.acoustics.aperture);
  using Shape = render::PulseSettings::Shape;
  section.choice("pulse", head.acoustics.physical.pulse.shape,
                 {{"tone", Shape::tone}, {"point", Shape::point}},
                 "`tone`: as long as the client requests; `point`: no length");
  section.boolean("snap_sound_speed", config.device.snap_sound_speed,
                  "true: the head rounds sound speeds to 1400 + 3.2 k m/s, as a real one");
  section.boolean("steering_error", config.steering_error,
                  "true: if the sound speed of the water differs from the ping configuration, bearings are "
                  "wrong, as in a flat array; false: only ranges are wrong");
  section.section("gain_law", "effect of the client's gain",
                  [&](YamlSection& inner) { read_gain_law(inner, config.device.gain); });
}

}  // namespace

GeminiConfig read_gemini_head(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  section.introduce(
      "A Tritech Gemini 720i ([messages](../protocol/gemini/README.md)). The x axis of its mount is the "
      "acoustic axis, so the mount includes the tilt of the bracket and the 10 degrees by which the device "
      "tilts its beam down.");
  GeminiConfig config;
  apply_water(section, context, gemini::carrier_hz, head);
  config.device.water_sound_speed_mps = context.water_sound_speed_mps;
  config.device.simulated_time = context.simulated_time;
  read_common(section, context, head);
  read_identity(section, config);
  section.require("network", "a mapping with alternate_address and netmask");
  section.section("network", "addresses and ports", [&](YamlSection& inner) { read_network(inner, config); });
  read_lock_to_first(section, config.device.lock_to_first,
                     "the first address is silent for `timing.client_timeout_ms`");
  section.section("timing", "rates, timeouts, pacing",
                  [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("acoustics", "formation of the image",
                  [&](YamlSection& inner) { read_gemini_acoustics(inner, head, config); });
  section.section("link", "faults of the head's datagrams, to test drivers",
                  [&](YamlSection& inner) { read_link_faults(inner, config.link); });
  section.section("trigger", "external trigger input", [&](YamlSection& inner) {
    inner.require("bind", trigger_form.expected);
    inner.parsed("bind", config.trigger.emplace(), &parse_endpoint, trigger_form,
                 "UDP address; each datagram from `network.allow` is a trigger edge");
  });
  return config;
}

}  // namespace sonard::server
