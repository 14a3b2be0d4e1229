// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping360/section.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "server/devices/ping/section.hpp"
#include "server/net/addresses.hpp"
#include "server/yaml/network_section.hpp"

namespace sonard::server {
namespace {

constexpr TextForm discovery_form{"an address and port such as 0.0.0.0:30303", endpoint_form.type,
                                  endpoint_form.schema, true};
constexpr TextForm address_form{"an IPv4 address such as 192.168.2.4", "address", address_schema, true};
constexpr TextForm mac_form{"six hexadecimal octets such as 54:10:ec:12:34:56", "six octets", mac_schema};

void read_discovery(YamlSection& section, DiscoveryConfig& discovery) {
  section.parsed("bind", discovery.bind, &parse_endpoint, discovery_form,
                 "UDP address for clients' searches; several heads may share it");
  section.default_is("bind", endpoint_text(discovery.bind), '"' + endpoint_text(discovery.bind) + '"');
  section.require("address", "the address in the answers to clients, at which a socket of udp is reachable");
  section.parsed("address", discovery.address, &parse_ipv4, address_form,
                 "address in the answers; a socket of `udp` must be reachable there");
  section.parsed("mac", discovery.mac, &parse_mac, mac_form, "MAC address in the answers to clients");
  section.default_is("mac", "54:10:ec:12:34:56");
  if (!section.has("bind")) {
    section.require("allow", "the address blocks to answer, because the socket is bound to all addresses");
  }
  read_allow_list(section, discovery.bind.address, discovery.allow,
                  "address blocks of clients that get an answer");
}

/// Warns if no socket is bound to the place to which clients that found the head send: the announced address
/// and one fixed port.
void warn_if_found_in_vain(YamlSection& section, const Ping360Config& config) {
  if (!config.discovery || config.discovery->address == 0) {
    return;
  }
  const Endpoint told{config.discovery->address, ping360_data_port};
  const bool served = std::ranges::any_of(config.udp, [&](const UdpTransportConfig& socket) {
    return socket.bind.port == told.port && (socket.bind.address == 0 || socket.bind.address == told.address);
  });
  if (!served) {
    section.warn("discovery.address",
                 fmt::format("clients that find the head send to {}, but no socket of udp is bound there",
                             endpoint_text(told)));
  }
}

void read_device(YamlSection& section, ping360::DeviceConfig& device) {
  read_identity(section, 1, "hardware revision that the head reports",
                "minor version of the firmware; above 3.3.0, ping-viewer lets a head scan by itself",
                device.id, device.information);
  section.integer("bearing_offset", device.bearing_offset, 0, 399,
                  "angle in gradians that is straight ahead; ping-viewer assumes 200, ROS drivers 0");
  section.boolean(
      "joins_repeated_commands", device.joins_repeated_commands,
      "true: a transducer command that repeats the client's last unanswered one shares its answer, because "
      "known clients repeat a command while the head turns; false: the head executes each command");
  section.integer(
      "queue_length", device.queue_length, 0, 100,
      "maximum number of commands that wait while the head executes another one; if the queue is full, the "
      "oldest command is dropped. 0: the head drops every command that arrives meanwhile");
  section.boolean("accepts_angle_400", device.accepts_angle_400,
                  "true: the head reads 400 gradians as 0, because one ROS driver sends 400");
  section.boolean("obeys_set_common_device_id", device.obeys_set_common_device_id,
                  "true: the head obeys message 100 like 2000; a real head refused it");
  section.boolean("signed_scan_angles", device.signed_scan_angles,
                  "true: the head reads scan limits as signed numbers: 65336 is -200 gradians");
  section.boolean("clamps_scan_to_stop", device.clamps_scan_to_stop,
                  "true: a sector ends at its limit; false: at the last whole step before it");
  section.boolean("ignores_other_destinations", device.ignores_other_destinations,
                  "true: the head drops frames to IDs other than its own, 0 and 255");
  read_receivers(section, "began the scan", device);
  section.integer("max_datagram", device.max_datagram, 0, 65'507,
                  "maximum size of a datagram in bytes; longer frames are split, for clients with short "
                  "buffers. 0: one datagram for each frame");
}

void read_timing(YamlSection& section, ping360::DeviceConfig& device) {
  section.duration("ping_overhead_ms", device.ping_overhead, Range::from(0.0, 10'000.0),
                   "overhead of each ping, in addition to turning and listening");
  section.duration("gradian_ms", device.time_per_gradian, Range::from(0.0, 1000.0),
                   "time to turn by one gradian (0.9 degrees)");
  read_time_scale(section, device.time_scale);
  section.duration("idle_timeout_ms", device.idle_timeout, Range::from(0.0, 60.0 * minute_ms),
                   "silence after which the head drops a client and ends its scan; 0: never");
  section.duration("reset_ms", device.reset_silence, Range::from(0.0, minute_ms), "silence after a reset");
  section.duration("bootloader_ms", device.bootloader_silence, Range::from(0.0, minute_ms),
                   "silence after a reset to the bootloader");
}

void read_transducer_band(YamlSection& section, render::TransducerBand& band) {
  section.introduce(
      "The transducer is modelled as one resonance. The manufacturer publishes the usable band, 650 to 850 "
      "kHz. The one-way loss of 3 dB at its ends is inferred.");
  section.number("low_khz", band.low_hz, Range::from(0.0, 10'000.0),
                 "lower end of the band (-3 dB each way); both ends 0: no band", 1e-3);
  section.number("high_khz", band.high_hz, Range::from(0.0, 10'000.0), "upper end of the band", 1e-3);
  const bool none = band.low_hz == 0.0 && band.high_hz == 0.0;
  if (!none && !(band.low_hz > 0.0 && band.high_hz > band.low_hz)) {
    section.report("high_khz", "is not above low_khz (expected 0 < low_khz < high_khz, or both 0)");
  }
}

void read_ping360_acoustics(YamlSection& section, HeadConfig& head, Ping360Config& config) {
  read_acoustics(section, ping360_carrier_hz, head);
  read_single_beam(section, head.acoustics.aperture);
  using Shape = render::PulseSettings::Shape;
  section.choice("pulse", head.acoustics.physical.pulse.shape,
                 {{"tone", Shape::tone}, {"point", Shape::point}},
                 "response in range: `tone`: as long as the client's pulse; `point`: no length");
  section.section("transducer_band", "frequencies that pass the transducer",
                  [&](YamlSection& inner) { read_transducer_band(inner, config.transducer_band); });
  using Scale = render::OutputScale;
  section.choice("output_scale", head.acoustics.output_scale,
                 {{"half_decibels", Scale::half_decibels}, {"linear", Scale::linear}},
                 "meaning of a step of a sample, which is not published");
  section.number("normal_gain_db", config.device.gain_db[1], Range::from(-100.0, 100.0),
                 "gain of setting 1 over setting 0");
  section.number("high_gain_db", config.device.gain_db[2], Range::from(-100.0, 100.0),
                 "gain of setting 2 over setting 0");
}

}  // namespace

Ping360Config read_ping360_head(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  section.introduce(
      "A Blue Robotics Ping360 on UDP or a serial line ([messages](../protocol/ping360/README.md)). It "
      "turns about the z axis of its mount. At the angle `device.bearing_offset` it looks along x.");
  Ping360Config config;
  apply_water(section, context, ping360_carrier_hz, head);
  config.water = context.absorption_db_per_m < 0.0
                     ? std::optional(render::Water{context.water.temperature_c, context.water.salinity_ppt,
                                                   context.water.depth_m, context.water.ph})
                     : std::nullopt;
  apply_context(context, config.device);
  read_common(section, context, head);
  read_lines(section, context, "UDP address; port 12345: a unit with Ethernet, 9092: a vehicle's bridge",
             config, config.device);
  section.section("discovery",
                  "answers to clients that search the network; without this section, clients find no head",
                  [&](YamlSection& inner) { read_discovery(inner, config.discovery.emplace()); });
  warn_if_found_in_vain(section, config);
  section.section("device",
                  "identity that the head reports, and behaviour that differs between firmware and clients",
                  [&](YamlSection& inner) { read_device(inner, config.device); });
  section.section("timing", "pace of pings, silence, resets",
                  [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("acoustics", "formation of the pings",
                  [&](YamlSection& inner) { read_ping360_acoustics(inner, head, config); });
  check_lock(section, config.device);
  return config;
}

}  // namespace sonard::server
