// SPDX-License-Identifier: Apache-2.0
#include "server/devices/gemini/section.hpp"

#include <fmt/format.h>

#include "protocol/gemini/messages.hpp"
#include "server/config/network_section.hpp"
#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

constexpr double minute_ms = 60'000.0;
constexpr std::string_view expected_address = "an IPv4 address such as 127.0.0.2";

void read_identity(YamlSection& section, GeminiConfig& config) {
  // 0 means "not set" and 1 is reserved for production: clients send nothing to either
  // (docs/protocols/gemini.md 1.4).
  section.require("sonar_id", "a whole number from 2 to 65535");
  section.integer("sonar_id", config.device.sonar_id, 2, 65535);
}

/// An address that a head can own or talk to.
void check_host_address(YamlSection& section, std::string_view key, Ipv4 address) {
  if (address == 0 || is_multicast(address) || address == 0xFFFFFFFF) {
    section.report(key, fmt::format("{} is not the address of one host (expected {})", address_text(address),
                                    expected_address));
  }
}

void check_inside_network(YamlSection& section, const gemini::DeviceConfig& device) {
  const std::optional<int> prefix = prefix_length_of(device.netmask);
  if (!prefix || *prefix == 0) {
    section.report("netmask",
                   fmt::format("{} is not a netmask (expected leading ones only, such as 255.255.255.0)",
                               address_text(device.netmask)));
    return;
  }
  const Ipv4 host = device.alternate_address & ~device.netmask;
  if (*prefix <= 30 && (host == 0 || host == ~device.netmask)) {
    section.report(
        "alternate_address",
        fmt::format("{} is the {} address of its network (expected the address of one host under mask {})",
                    address_text(device.alternate_address), host == 0 ? "first" : "broadcast",
                    address_text(device.netmask)));
  }
}

void read_status_destination(YamlSection& section, const gemini::DeviceConfig& device,
                             StatusDestination& status) {
  using Mode = StatusDestination::Mode;
  if (section.is_list("status")) {
    status.mode = Mode::unicast;
    section.parsed_list("status", status.hosts, &parse_ipv4, expected_address);
    if (status.hosts.empty()) {
      section.report("status", "no host is listed (expected at least one address)");
    }
    for (const Ipv4 host : status.hosts) {
      check_host_address(section, "status", host);
    }
    return;
  }
  section.choice(
      "status", status.mode,
      {{"limited_broadcast", Mode::limited_broadcast}, {"directed_broadcast", Mode::directed_broadcast}});
  const std::optional<int> prefix = prefix_length_of(device.netmask);
  if (status.mode == Mode::directed_broadcast && prefix && *prefix > 30) {
    section.report("status",
                   fmt::format("mask {} leaves no broadcast address (expected limited_broadcast or a list)",
                               address_text(device.netmask)));
  }
}

void read_network(YamlSection& section, GeminiConfig& config, std::vector<ConfigWarning>& warnings) {
  gemini::DeviceConfig& device = config.device;
  section.require("alternate_address", "the address that clients find in the status packets");
  section.parsed("alternate_address", device.alternate_address, &parse_ipv4, expected_address);
  if (section.has("alternate_address")) {
    check_host_address(section, "alternate_address", device.alternate_address);
  }
  section.require("netmask", "the mask of the interface that is served, such as 255.255.255.0");
  section.parsed("netmask", device.netmask, &parse_ipv4, "a netmask such as 255.255.255.0");
  check_inside_network(section, device);
  section.parsed("fixed_address", device.fixed_address, &parse_ipv4, expected_address);
  check_host_address(section, "fixed_address", device.fixed_address);

  config.bind_address = device.alternate_address;
  section.place_default("bind", "alternate_address");
  section.parsed("bind", config.bind_address, &parse_ipv4,
                 "an address of this machine, or 0.0.0.0 for all of them");
  if (config.bind_address != 0 && config.bind_address != device.alternate_address) {
    warnings.push_back(
        {section.path_of("bind"),
         fmt::format("clients send to the alternate address {}, but only {} is listened on",
                     address_text(device.alternate_address), address_text(config.bind_address))});
  }
  section.integer("command_port", config.command_port, 1, 65535);
  section.integer("surface_port", device.topside_port, 1, 65535);

  const std::uint16_t id = device.sonar_id;
  device.mac = {
      0x00, 0x12, 0x34, 0x00, static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id & 255U)};
  section.parsed("mac", device.mac, &parse_mac, "six hexadecimal octets such as 00:12:34:00:02:01");
  section.boolean("accept_id_zero", device.accept_id_zero);

  read_status_destination(section, device, config.status);
  read_allow_list(section, config.bind_address, config.allow);
  for (const Ipv4 host : config.status.hosts) {
    if (!config.allow.empty() && !allows(config.allow, host)) {
      warnings.push_back(
          {section.path_of("status"),
           fmt::format("{} gets status packets but is not in `allow`: its commands are dropped",
                       address_text(host))});
    }
  }
}

void read_timing(YamlSection& section, gemini::DeviceConfig& device) {
  section.duration("status_period_ms", device.status_period, Range::from(10.0, minute_ms));
  section.duration("min_ping_period_ms", device.min_ping_period, Range::from(1.0, minute_ms));
  section.duration("surface_timeout_ms", device.topside_timeout, Range::from(10.0, 3600.0 * 1000.0));
  section.duration("reboot_time_ms", device.reboot_time, Range::from(0.0, minute_ms));
  section.duration("line_period_us", device.line_period, Range::from(1.0, 10'000.0));
  section.integer("burst_lines", device.burst_lines, 1, 1024);
  section.duration("retry_hold_ms", device.retry_hold, Range::from(0.0, 10'000.0));
  section.duration("retry_hold_max_ms", device.retry_hold_max, Range::from(0.0, 10'000.0));
  if (device.retry_hold_max < device.retry_hold) {
    section.report("retry_hold_max_ms", "is shorter than retry_hold_ms (expected at least as long)");
  }
  section.duration("render_lead_ms", device.render_lead, Range::from(0.0, 1000.0));
}

void read_gain_law(YamlSection& section, gemini::GainLaw& law) {
  section.number("reference_spreading", law.reference_spreading, Range::above(0.0, 1023.0));
  section.number("db_per_percent", law.db_per_percent, Range::from(0.0, 10.0));
  section.number("nominal_main_gain_db", law.nominal_main_gain_db, Range::from(0.0, 100.0));
}

void read_receive_array(YamlSection& section, render::Aperture& aperture) {
  using Taper = render::Aperture::Taper;
  using Azimuth = render::Aperture::Azimuth;
  section.choice("azimuth_pattern", aperture.azimuth, {{"array", Azimuth::array}, {"ideal", Azimuth::ideal}});
  section.choice("taper", aperture.taper,
                 {{"hamming", Taper::hamming},
                  {"hann", Taper::hann},
                  {"kaiser", Taper::kaiser},
                  {"uniform", Taper::uniform}});
  using Bearing = render::Aperture::Bearing;
  section.choice("bearing", aperture.bearing, {{"planar", Bearing::planar}, {"conical", Bearing::conical}});
  section.integer("fine_beams", aperture.fine_beams, 1, 16);
  section.number("element_amplitude_sd", aperture.element_amplitude_sd, Range::from(0.0, 2.0));
  section.angle("element_phase_sd_deg", aperture.element_phase_sd_rad, Range::from(0.0, 180.0));
}

void read_gemini_acoustics(YamlSection& section, HeadConfig& head, GeminiConfig& config) {
  read_acoustics(section, gemini::carrier_hz, head);
  read_receive_array(section, head.acoustics.aperture);
  using Pulse = render::PhysicalModel::Pulse;
  section.choice("pulse", head.acoustics.physical.pulse, {{"tone", Pulse::tone}, {"point", Pulse::point}});
  section.angle("receive_beamwidth_deg", head.acoustics.aperture.receive_beamwidth_rad,
                Range::from(0.1, 60.0));
  section.boolean("snap_sound_speed", config.device.snap_sound_speed);
  section.boolean("steering_error", config.steering_error);
  section.section("gain_law", [&](YamlSection& inner) { read_gain_law(inner, config.device.gain); });
}

}  // namespace

GeminiConfig read_gemini_head(YamlSection& section, const HeadContext& context, HeadConfig& head,
                              std::vector<ConfigWarning>& warnings) {
  GeminiConfig config;
  apply_water(context, gemini::carrier_hz, head, warnings);
  config.device.water_sound_speed_mps = context.water_sound_speed_mps;
  config.device.waits_for_permission = context.pings_by_source;
  read_common(section, context, head);
  read_identity(section, config);
  section.require("network", "a mapping with alternate_address and netmask");
  section.section("network", [&](YamlSection& inner) { read_network(inner, config, warnings); });
  section.section("timing", [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("acoustics", [&](YamlSection& inner) { read_gemini_acoustics(inner, head, config); });
  section.section("link", [&](YamlSection& inner) { read_link_faults(inner, config.link); });
  section.section("trigger", [&](YamlSection& inner) {
    Endpoint bind;
    inner.require("bind", "an address and port such as 127.0.0.1:14700");
    inner.parsed("bind", bind, &parse_endpoint, "an address and port such as 127.0.0.1:14700");
    config.trigger = bind;
  });
  return config;
}

}  // namespace sonard::server
