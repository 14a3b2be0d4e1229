// SPDX-License-Identifier: Apache-2.0
#include "server/devices/micron/section.hpp"

#include "protocol/micron/recorded_form.hpp"
#include "server/yaml/network_section.hpp"

namespace sonard::server {
namespace {

constexpr double minute_ms = 60'000.0;

void read_device(YamlSection& section, micron::DeviceConfig& device) {
  section.integer("node", device.node, 1, 254,
                  "address of the head on the line; the head ignores other addresses");
  section.integer("serial_number", device.version.serial_number, 0, 65535,
                  "serial number in the version data");
  section.choice("duplex", device.half_duplex, {{"full", false}, {"half", true}},
                 "`full`: two lines for each request; `half`: one line, as in a head on RS485");
  section.choice("user_blocks", device.user_blocks,
                 {{"dst", micron::UserBlocks::dst},
                  {"dst_alone", micron::UserBlocks::dst_alone},
                  {"older", micron::UserBlocks::older}},
                 "answer to mtSendBBUser: `dst`: 264 bytes, followed by the FPGA data; `dst_alone`: only the "
                 "264 bytes, for libminiking; `older`: only 175 bytes, as from a head that is not a DST");
  section.boolean("mounted_inverted", device.mounted_inverted,
                  "true: the head is mounted boot down. Left and right are correct if this key and the "
                  "client's invert bit agree");
  section.choice(
      "nibble_order", device.nibble_order,
      {{"high_first", micron::NibbleOrder::high_first}, {"low_first", micron::NibbleOrder::low_first}},
      "half of a byte with the nearer of two 4-bit bins");
  section.choice("limits_order", device.limits_order,
                 {{"clockwise", micron::LimitsOrder::clockwise}, {"swapped", micron::LimitsOrder::swapped}},
                 "if the left limit is larger: `clockwise`: the sector runs through astern; `swapped`: the "
                 "limits are exchanged");
  section.boolean("always_reports_scan_right", device.always_reports_scan_right,
                  "true: lines always report the direction \"scan right\"");
  section.boolean("alive_while_scanning", device.alive_while_scanning,
                  "true: alives come between lines, too; some drivers block without them");
  section.boolean("alive_after_head_command", device.alive_after_head_command,
                  "true: the head answers a head command at once with an extra alive");
  section.boolean("direction_bit_kept", device.direction_bit_kept,
                  "true: alives report \"off centre\" after centring too");
  section.renamed("clock_follows_host", "clock_follows_client");
  section.boolean("clock_follows_client", device.clock_follows_client,
                  "true: a request with a time of day sets the clock of the head");
  section.integer("request_cap", device.request_cap, 1, 100,
                  "maximum number of stored requests; many clients request more lines than they wait for");
  section.boolean("requests_survive_head_command", device.requests_survive_head_command,
                  "true: new parameters keep the lines that were requested before");
}

void read_timing(YamlSection& section, micron::DeviceConfig& device) {
  section.duration("boot_ms", device.boot_time, Range::from(0.0, 999.0),
                   "silence after a reboot. When the daemon starts, its heads are already on and centred");
  section.duration(
      "centring_ms", device.least_centring_time, Range::from(0.0, 15'000.0),
      "minimum time of centring after a reboot. Above 1000, a driver gets two alives; above 1800, its "
      "watchdog may reboot again ([drivers](your-micron-driver.md#what-drivers-need-of-a-reboot))");
  section.angle("seek_speed_deg", device.seek_speed_rad_s, Range::above(0.0, 36'000.0),
                "turning speed while centring, degrees per second");
  section.duration("alive_period_ms", device.alive_period, Range::from(10.0, minute_ms),
                   "period of the alives");
  section.duration("reconfiguration_ms", device.reconfiguration_time, Range::from(0.0, minute_ms),
                   "time from new parameters to the first ping");
  section.duration("reposition_limit_ms", device.reposition_limit, Range::from(0.0, minute_ms),
                   "maximum of `reconfiguration_ms` and the way to a sector together");
  section.integer("link_baud", device.baud, 300, 4'000'000,
                  "assumed line speed in bits per second; it sets the pace on any transport");
  section.duration("line_overhead_ms", device.line_overhead, Range::from(0.0, 1000.0),
                   "overhead of each line, in addition to listening, turning and sending");
  double line_period_ms = -1.0;
  section.number_or_word("line_period_ms", line_period_ms, Range::from(0.0, minute_ms), {{"device", -1.0}},
                         "time from line to line; 0: as fast as lines are rendered");
  if (line_period_ms >= 0.0) {
    device.line_period = std::chrono::nanoseconds(static_cast<std::int64_t>(1e6 * line_period_ms));
  }
}

void read_micron_acoustics(YamlSection& section, HeadConfig& head, MicronConfig& config) {
  read_acoustics(section, micron::carrier_hz, head);
  read_single_beam(section, head.acoustics.aperture);
  section.number("nominal_gain_db", config.nominal_gain_db, Range::from(0.0, 80.0),
                 "initial gain of the client (of 80 dB) at which the level is `physical.gain_db`");
  using Shape = render::PulseSettings::Shape;
  section.choice(
      "pulse", head.acoustics.physical.pulse.shape,
      {{"chirp", Shape::chirp}, {"windowed_chirp", Shape::windowed_chirp}, {"point", Shape::point}},
      "response in range: `chirp` has side lobes of -13 dB; `windowed_chirp` has side lobes of -31 dB and is "
      "1.6 times as wide; `point` has no length");
  section.number("chirp_bandwidth_khz", config.chirp_bandwidth_hz, Range::from(0.0, 10'000.0),
                 "bandwidth of the chirp, which sets the range cell (default: 7.5 mm)", 1e-3);
  section.number("bin_overlap", head.acoustics.physical.bin_overlap, Range::from(0.0, 1.0),
                 "weight of the adjoining halves of the neighbouring bins in a bin; its own halves have 1. "
                 "With 0.55, neighbours have a correlation of 0.42, as in recordings");
}

}  // namespace

MicronConfig read_micron_head(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  section.introduce(
      "A Tritech Micron DST on its serial line ([messages](../protocol/micron/README.md)). It turns about "
      "the z axis of its mount, and its \"ahead\" is the x axis. `rpy_deg` [0, 0, 0] is a head on top of the "
      "vehicle, [0, 90, 0] a head that scans the upright plane across the vehicle.");
  MicronConfig config;
  apply_water(section, context, micron::carrier_hz, head);
  // This sound speed turns times into ranges; clients assume 1500 m/s (protocol/micron/README.md 4).
  config.device.simulated_time = context.simulated_time;
  if (context.water_sound_speed_mps > 0.0) {
    config.device.water_sound_speed_mps = context.water_sound_speed_mps;
  }
  read_common(section, context, head);
  section.require("serial", "a mapping with tcp, udp or pty");
  section.section("serial", "how clients connect to the serial line",
                  [&](YamlSection& inner) { config.serial = read_serial_link(inner, context.folder); });
  read_lock_to_first(section, config.serial.lock_to_first,
                     "the first address is silent for 10 s; other clients still receive answers");
  section.section("device",
                  "identity that the head reports, and behaviour that differs between drivers and heads",
                  [&](YamlSection& inner) { read_device(inner, config.device); });
  section.section("timing", "reboot, pace of lines",
                  [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("acoustics", "formation of the lines",
                  [&](YamlSection& inner) { read_micron_acoustics(inner, head, config); });
  return config;
}

}  // namespace sonard::server
