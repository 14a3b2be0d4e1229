// SPDX-License-Identifier: Apache-2.0
#include "server/devices/gemini/section.hpp"

#include <fmt/format.h>

#include "protocol/gemini/messages.hpp"
#include "server/config/network_section.hpp"
#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

constexpr double minute_ms = 60'000.0;
constexpr TextForm address_form{"an IPv4 address such as 127.0.0.2", "address", address_schema};
constexpr TextForm addresses_form{address_form.expected, "addresses", address_schema};
constexpr TextForm netmask_form{"a netmask such as 255.255.255.0", "netmask", address_schema};
constexpr TextForm bind_form{"an address of this machine, or 0.0.0.0 for all of them", "address",
                             address_schema};
constexpr TextForm mac_form{"six hexadecimal octets such as 00:12:34:00:02:01", "six octets", mac_schema};
constexpr TextForm trigger_form{"an address and port such as 127.0.0.1:14700", endpoint_form.type,
                                endpoint_form.schema};

void read_identity(YamlSection& section, GeminiConfig& config) {
  // 0 means "not set" and 1 is reserved for production: clients send nothing to either
  // (docs/protocols/gemini.md 1.4).
  section.require("sonar_id", "a whole number from 2 to 65535");
  section.integer("sonar_id", config.device.sonar_id, 2, 65535, "unique; clients never talk to 0 and 1");
}

/// An address that a head can own or talk to.
void check_host_address(YamlSection& section, std::string_view key, Ipv4 address) {
  if (address == 0 || is_multicast(address) || address == 0xFFFFFFFF) {
    section.report(key, fmt::format("{} is not the address of one host (expected {})", address_text(address),
                                    address_form.expected));
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
  if (!section.is_list("status")) {
    section.choice(
        "status", status.mode,
        {{"limited_broadcast", Mode::limited_broadcast}, {"directed_broadcast", Mode::directed_broadcast}},
        "where status packets go, once a second: 255.255.255.255 as the device does, the broadcast address "
        "of `alternate_address` under `netmask`, or these hosts");
  }
  if (section.is_list("status") || section.describing()) {
    status.mode = Mode::unicast;
    section.parsed_list("status", status.hosts, &parse_ipv4, addresses_form, "",
                        "no host is listed (expected at least one address)");
    for (const Ipv4 host : status.hosts) {
      check_host_address(section, "status", host);
    }
  }
  const std::optional<int> prefix = prefix_length_of(device.netmask);
  if (status.mode == Mode::directed_broadcast && prefix && *prefix > 30) {
    section.report("status",
                   fmt::format("mask {} leaves no broadcast address (expected limited_broadcast or a list)",
                               address_text(device.netmask)));
  }
}

void read_network(YamlSection& section, GeminiConfig& config) {
  gemini::DeviceConfig& device = config.device;
  section.require("alternate_address", "the address that clients find in the status packets");
  section.parsed(
      "alternate_address", device.alternate_address, &parse_ipv4, address_form,
      "the address that clients find in the status packets and send to; the head must be reachable there");
  if (section.has("alternate_address")) {
    check_host_address(section, "alternate_address", device.alternate_address);
  }
  section.require("netmask", "the mask of the interface that is served, such as 255.255.255.0");
  section.parsed("netmask", device.netmask, &parse_ipv4, netmask_form,
                 "the true mask of the interface served: some clients send nothing when it is not that of "
                 "their own interface");
  check_inside_network(section, device);
  const std::string fixed_address = address_text(device.fixed_address);
  section.parsed("fixed_address", device.fixed_address, &parse_ipv4, address_form,
                 "the hard-wired address of a 720i, reported in the status packets; served too where the "
                 "machine has it and `bind` is 0.0.0.0");
  section.default_is("fixed_address", fixed_address, '"' + fixed_address + '"');
  check_host_address(section, "fixed_address", device.fixed_address);

  config.bind_address = device.alternate_address;
  section.place_default("bind", "alternate_address");
  section.parsed("bind", config.bind_address, &parse_ipv4, bind_form,
                 "address of the command socket; 0.0.0.0 for all of the machine");
  section.default_is("bind", "the alternate address");
  if (config.bind_address != 0 && config.bind_address != device.alternate_address) {
    section.warn("bind",
                 fmt::format("clients send to the alternate address {}, but only {} is listened on",
                             address_text(device.alternate_address), address_text(config.bind_address)));
  }
  section.integer("command_port", config.command_port, 1, 65535,
                  "commands arrive here, replies come from here");
  section.integer("surface_port", device.topside_port, 1, 65535,
                  "every reply and status packet goes to this port");

  const std::uint16_t id = device.sonar_id;
  device.mac = {
      0x00, 0x12, 0x34, 0x00, static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id & 255U)};
  section.parsed("mac", device.mac, &parse_mac, mac_form, "reported in the status packets");
  section.default_is("mac", "00:12:34:00 and the sonar ID");
  section.boolean("accept_id_zero", device.accept_id_zero, "also take commands with the header ID 0");

  read_status_destination(section, device, config.status);
  read_allow_list(section, config.bind_address, config.allow, "clients that are served");
  for (const Ipv4 host : config.status.hosts) {
    if (!config.allow.empty() && !allows(config.allow, host)) {
      section.warn("status",
                   fmt::format("{} gets status packets but is not in `allow`: its commands are dropped",
                               address_text(host)));
    }
  }
}

void read_timing(YamlSection& section, gemini::DeviceConfig& device) {
  section.duration("status_period_ms", device.status_period, Range::from(10.0, minute_ms),
                   "from status packet to status packet");
  section.duration("min_ping_period_ms", device.min_ping_period, Range::from(1.0, minute_ms),
                   "shortest time from ping to ping, whatever the client asks");
  section.duration("surface_timeout_ms", device.topside_timeout, Range::from(10.0, 3600.0 * 1000.0),
                   "without a command for this long the head forgets its topside and suspends pinging");
  section.duration("reboot_time_ms", device.reboot_time, Range::from(0.0, minute_ms),
                   "silence after a reboot command");
  section.duration("line_period_us", device.line_period, Range::from(1.0, 10'000.0),
                   "least mean distance of ping datagrams: a line on a 100 Mbit/s link");
  section.integer("burst_lines", device.burst_lines, 1, 1024, "most ping datagrams sent back to back");
  section.duration("retry_hold_ms", device.retry_hold, Range::from(0.0, 10'000.0),
                   "a new ping waits this long after the last request to send lines again");
  section.duration("retry_hold_max_ms", device.retry_hold_max, Range::from(0.0, 10'000.0),
                   "but never longer than this");
  if (device.retry_hold_max < device.retry_hold) {
    section.report("retry_hold_max_ms", "is shorter than retry_hold_ms (expected at least as long)");
  }
  section.duration(
      "render_lead_ms", device.render_lead, Range::from(0.0, 1000.0),
      "how long before its transmit time a ping may be rendered. 0: when the pose at that time is known. "
      "More raises the ping rate of a slow renderer; the pose is then extrapolated by so much");
}

void read_gain_law(YamlSection& section, gemini::GainLaw& law) {
  section.introduce("The device's own law is not published; this one is inferred from what clients send.");
  section.number("reference_spreading", law.reference_spreading, Range::above(0.0, 1023.0),
                 "value of the `spreading` field that gives 0 dB: what early clients send for 50 percent. "
                 "Later ones send 213");
  section.number("db_per_percent", law.db_per_percent, Range::from(0.0, 10.0),
                 "dB per percent of gain, as early clients count it");
  section.number("nominal_main_gain_db", law.nominal_main_gain_db, Range::from(0.0, 100.0),
                 "main gain at which the level is 0 dB");
}

void read_receive_array(YamlSection& section, render::Aperture& aperture) {
  section.angle("receive_beamwidth_deg", aperture.receive_beamwidth_rad, Range::from(0.1, 60.0),
                "-3 dB width of one beam at broadside: the pattern of the beams, and over how many beams "
                "speckle and noise are correlated");
  using Taper = render::Aperture::Taper;
  using Azimuth = render::Aperture::Azimuth;
  section.choice("azimuth_pattern", aperture.azimuth, {{"array", Azimuth::array}, {"ideal", Azimuth::ideal}},
                 "beams overlap and have side lobes as a straight array's do, or receive what lies between "
                 "their edges and nothing else");
  section.choice("taper", aperture.taper,
                 {{"hamming", Taper::hamming},
                  {"hann", Taper::hann},
                  {"kaiser", Taper::kaiser},
                  {"uniform", Taper::uniform}},
                 "weights of the array's elements: side lobes of -43, -31, -21 (beta 2.5) or -13 dB");
  section.integer("fine_beams", aperture.fine_beams, 1, 16,
                  "with `array`: a bearing is known to one part in this many of a beam");
  using Bearing = render::Aperture::Bearing;
  section.choice("bearing", aperture.bearing, {{"planar", Bearing::planar}, {"conical", Bearing::conical}},
                 "with `array`: a beam looks at an azimuth, or, as a straight array does, along a cone: what "
                 "lies off the horizontal appears nearer to the axis");
  section.number("element_amplitude_sd", aperture.element_amplitude_sd, Range::from(0.0, 2.0),
                 "with `array`: standard deviation of the elements' amplitude errors, as a share; they let "
                 "strong echoes leak into all beams. The errors belong to `seed`");
  section.angle("element_phase_sd_deg", aperture.element_phase_sd_rad, Range::from(0.0, 180.0),
                "the same of their phase errors");
}

void read_gemini_acoustics(YamlSection& section, HeadConfig& head, GeminiConfig& config) {
  read_acoustics(section, gemini::carrier_hz, head);
  read_receive_array(section, head.acoustics.aperture);
  using Pulse = render::PhysicalModel::Pulse;
  section.choice("pulse", head.acoustics.physical.pulse, {{"tone", Pulse::tone}, {"point", Pulse::point}},
                 "as long as the client asks for, or without length");
  section.boolean("snap_sound_speed", config.device.snap_sound_speed,
                  "report speeds of sound on the grid of the real head, 1400 m/s and steps of 3.2 m/s");
  section.boolean("steering_error", config.steering_error,
                  "where the water has another speed of sound than the ping configuration says, beams point "
                  "where those of a flat array do then; false: only ranges are off");
  section.section("gain_law", "what the client's gain does",
                  [&](YamlSection& inner) { read_gain_law(inner, config.device.gain); });
}

}  // namespace

GeminiConfig read_gemini_head(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  section.introduce(
      "A Tritech Gemini 720i ([protocols/gemini.md](protocols/gemini.md)). The x axis of its mount is the "
      "acoustic axis, so the down tilt of the head is part of the mount.");
  GeminiConfig config;
  apply_water(section, context, gemini::carrier_hz, head);
  config.device.water_sound_speed_mps = context.water_sound_speed_mps;
  config.device.waits_for_permission = context.pings_by_source;
  read_common(section, context, head);
  read_identity(section, config);
  section.require("network", "a mapping with alternate_address and netmask");
  section.section("network", "addresses", [&](YamlSection& inner) { read_network(inner, config); });
  section.section("timing", "rates, time-outs, pacing",
                  [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("acoustics", "how its image is formed",
                  [&](YamlSection& inner) { read_gemini_acoustics(inner, head, config); });
  section.section("link", "faults put on its datagrams, to test drivers with",
                  [&](YamlSection& inner) { read_link_faults(inner, config.link); });
  section.section("trigger", "external trigger input", [&](YamlSection& inner) {
    inner.require("bind", trigger_form.expected);
    inner.parsed("bind", config.trigger.emplace(), &parse_endpoint, trigger_form,
                 "every UDP datagram that arrives here counts as one edge of the external trigger. Only "
                 "senders in the head's `network.allow` count");
  });
  return config;
}

}  // namespace sonard::server
