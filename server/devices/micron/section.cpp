// SPDX-License-Identifier: Apache-2.0
#include "server/devices/micron/section.hpp"

#include "protocol/micron/recorded_form.hpp"
#include "server/config/network_section.hpp"

namespace sonard::server {
namespace {

constexpr double minute_ms = 60'000.0;

void read_device(YamlSection& section, micron::DeviceConfig& device) {
  section.integer("node", device.node, 1, 254, "address on the line; the head is deaf to others");
  section.integer("serial_number", device.version.serial_number, 0, 65535, "in its version data");
  section.choice("duplex", device.half_duplex, {{"full", false}, {"half", true}},
                 "two lines for a request, or one, as a head on RS485");
  section.choice("user_blocks", device.user_blocks,
                 {{"dst", micron::UserBlocks::dst},
                  {"dst_alone", micron::UserBlocks::dst_alone},
                  {"older", micron::UserBlocks::older}},
                 "the answer to mtSendBBUser: 264 bytes with the FPGA data behind them; 264 bytes alone, for "
                 "libminiking; 175 bytes alone, of a head that is no DST");
  section.boolean("mounted_inverted", device.mounted_inverted,
                  "the head is mounted boot down. Left and right are right when this and the client's invert "
                  "bit agree; set it for a client that always sets the bit");
  section.choice(
      "nibble_order", device.nibble_order,
      {{"high_first", micron::NibbleOrder::high_first}, {"low_first", micron::NibbleOrder::low_first}},
      "which half of a byte holds the nearer of two bins of 4-bit data: most drivers want the high one");
  section.choice("limits_order", device.limits_order,
                 {{"clockwise", micron::LimitsOrder::clockwise}, {"swapped", micron::LimitsOrder::swapped}},
                 "what a sector is whose left limit is the larger number: one through astern, or one whose "
                 "limits the client has confused");
  section.boolean("always_reports_scan_right", device.always_reports_scan_right, "whatever the direction");
  section.boolean("alive_while_scanning", device.alive_while_scanning,
                  "the alive of each second comes between lines too; some drivers block without");
  section.boolean("alive_after_head_command", device.alive_after_head_command,
                  "an alive answers a head command at once, beside the regular ones");
  section.boolean("direction_bit_kept", device.direction_bit_kept,
                  "alives tell \"off centre\" after centring, too");
  section.boolean("clock_follows_host", device.clock_follows_host,
                  "a request with a time of day sets the clock of the head");
  section.integer("request_cap", device.request_cap, 1, 100,
                  "requests remembered: many clients ask for more than they wait for");
  section.boolean("requests_survive_head_command", device.requests_survive_head_command,
                  "lines that are owed come with the new parameters");
}

void read_timing(YamlSection& section, micron::DeviceConfig& device) {
  section.duration(
      "boot_ms", device.boot_time, Range::from(0.0, 999.0),
      "deaf and dumb after a reboot; when the daemon starts, its heads have long been on and are centred");
  section.duration(
      "centring_ms", device.least_centring_time, Range::from(0.0, 15'000.0),
      "the least time of centring after a reboot, also for a head at its centre. Above 1000 a "
      "driver gets two alives of it; above about 1800 a driver with a watchdog reboots the head again. "
      "A long way to the centre takes longer");
  section.angle("seek_speed_deg", device.seek_speed_rad_s, Range::above(0.0, 36'000.0),
                "degrees per second while centring");
  section.duration("alive_period_ms", device.alive_period, Range::from(10.0, minute_ms),
                   "from alive to alive");
  section.duration("reconfiguration_ms", device.reconfiguration_time, Range::from(0.0, minute_ms),
                   "from parameters to the first ping");
  section.duration("reposition_limit_ms", device.reposition_limit, Range::from(0.0, minute_ms),
                   "most of that and the way to a sector together");
  section.integer("link_baud", device.baud, 300, 4'000'000,
                  "of the line by which the head is thought to send: with listening and turning it gives the "
                  "pace of lines, whatever carries them here");
  section.duration("line_overhead_ms", device.line_overhead, Range::from(0.0, 1000.0),
                   "of each line, beside listening, turning and sending");
  double line_period_ms = -1.0;
  section.number_or_word(
      "line_period_ms", line_period_ms, Range::from(0.0, minute_ms), {{"device", -1.0}},
      "time from line to line instead of the one of the device; 0: as fast as they are rendered");
  if (line_period_ms >= 0.0) {
    device.line_period = std::chrono::nanoseconds(static_cast<std::int64_t>(1e6 * line_period_ms));
  }
}

void read_micron_acoustics(YamlSection& section, HeadConfig& head, MicronConfig& config) {
  read_acoustics(section, micron::carrier_hz, head);
  read_single_beam(section, head.acoustics.aperture);
  section.number("nominal_gain_db", config.nominal_gain_db, Range::from(0.0, 80.0),
                 "initial gain of the client, of 80 dB, at which the level is that of `physical.gain_db`");
  using Pulse = render::PhysicalModel::Pulse;
  section.choice(
      "pulse", head.acoustics.physical.pulse,
      {{"chirp", Pulse::chirp}, {"windowed_chirp", Pulse::windowed_chirp}, {"point", Pulse::point}},
      "response in range: side lobes of -13 dB, of -31 dB and 1.6 times as wide, or no length");
  section.number("chirp_bandwidth_khz", config.chirp_bandwidth_hz, Range::from(0.0, 10'000.0),
                 "sets the range cell, 7.5 mm at 1500 m/s; 0 is a pulse without length", 1e-3);
  section.number(
      "bin_overlap", head.acoustics.physical.bin_overlap, Range::from(0.0, 1.0),
      "weight of the adjoining halves of the neighbouring bins in the level of a bin, whose own two "
      "halves weigh 1. 0.55 gives neighbours a correlation of 0.42, as recordings show; 0: a bin is "
      "the mean of its own range cells");
}

}  // namespace

MicronConfig read_micron_head(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  section.introduce(
      "A Tritech Micron DST on its serial line ([protocols/micron.md](protocols/micron.md)). It turns about "
      "the z axis of its mount and looks along x where it says \"ahead\": `rpy_deg` [0, 0, 0] is a head on "
      "top of the vehicle, [0, 90, 0] one that scans the upright plane across it.");
  MicronConfig config;
  apply_water(section, context, micron::carrier_hz, head);
  // What turns its times into ranges; hosts reckon with 1500 m/s (docs/protocols/micron.md 4).
  config.device.waits_for_permission = context.pings_by_source;
  if (context.water_sound_speed_mps > 0.0) {
    config.device.water_sound_speed_mps = context.water_sound_speed_mps;
  }
  read_common(section, context, head);
  section.require("serial", "a mapping with tcp, udp or pty");
  section.section("serial", "how clients reach the line",
                  [&](YamlSection& inner) { config.serial = read_serial_link(inner, context.folder); });
  read_lock_to_first(section, config.serial.lock_to_first,
                     "the first address is silent for 10 s; other clients still receive answers");
  section.section("device", "what it says of itself, and choices in which drivers and heads differ",
                  [&](YamlSection& inner) { read_device(inner, config.device); });
  section.section("timing", "reboot, pace", [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("acoustics", "how its lines are formed",
                  [&](YamlSection& inner) { read_micron_acoustics(inner, head, config); });
  return config;
}

}  // namespace sonard::server
