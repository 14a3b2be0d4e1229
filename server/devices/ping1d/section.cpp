// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping1d/section.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include "server/yaml/network_section.hpp"

namespace sonard::server {
namespace {

constexpr double minute_ms = 60'000.0;
constexpr TextForm length_form{"a length in metres from 1 to 100", "lengths",
                               R"("type": "number", "minimum": 1, "maximum": 100)"};

std::optional<double> parse_length(std::string_view text) {
  double metres = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), metres);
  const bool number = error == std::errc{} && end == text.data() + text.size();
  return number && metres >= 1.0 && metres <= 100.0 ? std::optional(metres) : std::nullopt;
}

void read_udp(YamlSection& section, const LinkConfig& link, Ping1dConfig& config) {
  const auto read = [&](YamlSection& inner) {
    UdpTransportConfig socket;
    read_socket(inner, socket.bind, socket.allow, endpoint_form,
                "UDP address; port 9090: a vehicle's bridge to the first such head",
                "address blocks that the head answers");
    report_if_taken(inner, socket.bind, config.udp);
    socket.link = link;
    config.udp.push_back(std::move(socket));
  };
  section.sections("udp", "sockets that clients send to; required without `serial`", read);
}

void read_identity(YamlSection& section, ping1d::DeviceConfig& device) {
  section.integer("id", device.id, 0, 254,
                  "device ID in the frames of the head, until a client sets another ID");
  section.integer("revision", device.information.device_revision, 1, 255,
                  "hardware revision that the head reports: 1 Ping1D, 2 Ping2");
  section.default_is("revision", "set by `model`");
  section.integer("firmware_major", device.information.firmware_major, 0, 255,
                  "major version of the firmware that the head reports");
  section.integer("firmware_minor", device.information.firmware_minor, 0, 255,
                  "minor version of the firmware; a hardware test expects 27 or above");
  section.integer("firmware_patch", device.information.firmware_patch, 0, 255,
                  "patch version of the firmware that the head reports");
  section.integer("voltage_mv", device.voltage_mv, 0, 65'535, "supply voltage that the head reports");
  section.integer("processor_temperature_cdeg", device.processor_temperature_cdeg, 0, 65'535,
                  "temperature of the processor that the head reports, in hundredths of a degree Celsius");
  section.integer("pcb_temperature_cdeg", device.pcb_temperature_cdeg, 0, 65'535,
                  "temperature of the board that the head reports, in hundredths of a degree Celsius");
}

void read_device(YamlSection& section, ping1d::DeviceConfig& device) {
  read_identity(section, device);
  section.integer("initial_length_mm", device.scan_length_mm, ping1d::least_length_mm, 100'000,
                  "length of the scan at boot");
  section.integer("initial_interval_ms", device.interval_ms, 0, 65'535, "least time between pings at boot");
  section.integer("initial_gain", device.gain_setting, 0, ping1d::most_gain, "gain setting at boot");
  section.integer("points", device.points, 10, 1000, "number of points of a profile");
  section.parsed_list("auto_lengths_m", device.auto_lengths_m, &parse_length, length_form,
                      "lengths of the scan in auto mode, rising", "is empty (expected a length)");
  section.default_is("auto_lengths_m", "1, 2, 5, 10, 20, 30, 50, 70, 100");
  if (std::ranges::adjacent_find(device.auto_lengths_m, std::ranges::greater_equal{}) !=
      device.auto_lengths_m.end()) {
    section.report("auto_lengths_m", "does not rise (expected lengths that grow)");
  }
  section.number("auto_target", device.auto_target, Range::from(0.5, 0.8),
                 "auto mode: share of the length at which the head wants its echo");
  section.integer("confidence_window", device.confidence_window, 1, 100,
                  "number of pings in the mean of the confidence");
  section.number("pulse_us_per_m", device.pulse_us_per_m, Range::above(0.0, 1000.0),
                 "transmit duration that the head reports, per metre of the scan");
  section.boolean("acknowledges", device.acknowledges, "true: an ack for each command that the head obeys");
  section.choice("auto_refusal", device.refuses_silently_in_auto, {{"nack", false}, {"silent", true}},
                 "answer to commands for range and gain in auto mode, which change nothing");
  section.boolean("accepts_any_destination", device.accepts_any_destination,
                  "true: the head also takes frames to IDs other than its own, 0 and 255");
  section.choice("fan_out", device.fan_out,
                 {{"requester", ping::FanOut::requester}, {"all", ping::FanOut::all}},
                 "clients that receive an answer: the client that asked or started the stream, or `all`, as "
                 "behind a vehicle's bridge");
  section.integer("max_clients", device.max_clients, 2, 1000,
                  "maximum number of clients; then the head drops the longest silent one");
}

void read_timing(YamlSection& section, ping1d::DeviceConfig& device) {
  section.duration("ping_overhead_ms", device.ping_overhead, Range::from(0.0, 10'000.0),
                   "overhead of each ping, in addition to listening");
  section.number("scale", device.time_scale, Range::from(0.0, 100.0),
                 "factor on the time from ping to ping; 0: as fast as pings are rendered");
  section.duration("idle_timeout_ms", device.idle_timeout, Range::from(0.0, 60.0 * minute_ms),
                   "silence after which the head drops a client on UDP and ends its stream, and after which "
                   "a head without a stream stops pinging; 0: never");
  section.duration("bootloader_ms", device.bootloader_silence, Range::from(0.0, minute_ms),
                   "silence after goto_bootloader");
}

void read_ping1d_acoustics(YamlSection& section, HeadConfig& head, Ping1dConfig& config) {
  section.default_is("vertical_beamwidth_deg", "set by `model`");
  section.default_is("beamwidth_deg", "set by `model`");
  read_acoustics(section, ping1d::carrier_hz, head);
  read_single_beam(section, head.acoustics.aperture);
  section.number("least_range_m", config.device.least_range_m, Range::from(0.0, 10.0),
                 "nearer echoes do not count as the distance, because the transducer rings");
  section.default_is("least_range_m", "set by `model`");
}

}  // namespace

Ping1dConfig read_ping1d_head(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  section.introduce(
      "A Blue Robotics Ping1D or Ping2 on UDP or a serial line "
      "([protocols/ping1d.md](protocols/ping1d.md)). Its one beam looks along the x axis of its mount: "
      "`rpy_deg: [0, 90, 0]` is straight down.");
  Ping1dConfig config;
  Ping1dModel model = Ping1dModel::ping1d;
  section.choice("model", model, {{"ping1d", Ping1dModel::ping1d}, {"ping2", Ping1dModel::ping2}},
                 "model of the device; it sets beam, least range and revision");
  head.acoustics = ping1d_acoustics(model);
  config.device.information.device_revision = model == Ping1dModel::ping1d ? 1 : 2;
  config.device.least_range_m = head.acoustics.physical.ring_down.end_m;
  apply_water(section, context, ping1d::carrier_hz, head);
  config.device.simulated_time = context.simulated_time;
  if (context.water_sound_speed_mps > 0.0) {
    config.device.water_sound_speed_mps = context.water_sound_speed_mps;
  }
  read_common(section, context, head);
  LinkConfig link;
  section.section("link", "faults of the datagrams of `udp`",
                  [&](YamlSection& inner) { read_link_faults(inner, link); });
  read_udp(section, link, config);
  section.section("serial", "serial line in addition to the sockets",
                  [&](YamlSection& inner) { config.serial = read_serial_link(inner, context.folder); });
  if (config.udp.empty() && !section.has("serial")) {
    section.report("udp", "no client could reach the head (expected udp with at least one item, or serial)");
  }
  if (section.has("serial")) {
    config.device.serial_channel = static_cast<int>(config.udp.size());
  }
  read_lock_to_first(section, config.device.lock_to_first,
                     "the first address is silent for `timing.idle_timeout_ms`, which must not be 0");
  config.serial.lock_to_first = config.device.lock_to_first;
  section.section("device",
                  "identity that the head reports, and behaviour that differs between firmware and clients",
                  [&](YamlSection& inner) { read_device(inner, config.device); });
  section.section("timing", "pace of pings, silence, restarts",
                  [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("acoustics", "formation of the pings",
                  [&](YamlSection& inner) { read_ping1d_acoustics(inner, head, config); });
  if (config.device.lock_to_first && config.device.idle_timeout.count() == 0) {
    section.report("lock_to_first", "would last for ever (expected timing.idle_timeout_ms above 0)");
  }
  return config;
}

}  // namespace sonard::server
