// SPDX-License-Identifier: Apache-2.0
#include "server/devices/micron/section.hpp"

#include <numbers>

#include "protocol/micron/recorded_form.hpp"
#include "server/config/network_section.hpp"

namespace sonard::server {
namespace {

constexpr double minute_ms = 60'000.0;
constexpr double degree = std::numbers::pi / 180.0;

void read_device(YamlSection& section, micron::DeviceConfig& device) {
  section.integer("node", device.node, 1, 254);
  section.integer("serial_number", device.version.serial_number, 0, 65535);
  section.choice("duplex", device.half_duplex, {{"full", false}, {"half", true}});
  section.choice("user_blocks", device.user_blocks,
                 {{"dst", micron::UserBlocks::dst},
                  {"dst_alone", micron::UserBlocks::dst_alone},
                  {"older", micron::UserBlocks::older}});
  section.boolean("mounted_inverted", device.mounted_inverted);
  section.choice(
      "nibble_order", device.nibble_order,
      {{"high_first", micron::NibbleOrder::high_first}, {"low_first", micron::NibbleOrder::low_first}});
  section.choice("limits_order", device.limits_order,
                 {{"clockwise", micron::LimitsOrder::clockwise}, {"swapped", micron::LimitsOrder::swapped}});
  section.boolean("always_reports_scan_right", device.always_reports_scan_right);
  section.boolean("alive_while_scanning", device.alive_while_scanning);
  section.boolean("alive_after_head_command", device.alive_after_head_command);
  section.boolean("direction_bit_kept", device.direction_bit_kept);
  section.boolean("clock_follows_host", device.clock_follows_host);
  section.integer("request_cap", device.request_cap, 1, 100);
  section.boolean("requests_survive_head_command", device.requests_survive_head_command);
}

void read_timing(YamlSection& section, micron::DeviceConfig& device) {
  section.duration("boot_ms", device.boot_time, Range::from(0.0, 999.0));
  section.duration("centring_ms", device.least_centring_time, Range::from(0.0, 15'000.0));
  section.angle("seek_speed_deg", device.seek_speed_rad_s, Range::above(0.0, 36'000.0));
  section.duration("alive_period_ms", device.alive_period, Range::from(10.0, minute_ms));
  section.duration("reconfiguration_ms", device.reconfiguration_time, Range::from(0.0, minute_ms));
  section.duration("reposition_limit_ms", device.reposition_limit, Range::from(0.0, minute_ms));
  section.integer("link_baud", device.baud, 300, 4'000'000);
  section.duration("line_overhead_ms", device.line_overhead, Range::from(0.0, 1000.0));
  double line_period_ms = -1.0;
  section.number_or_word("line_period_ms", line_period_ms, Range::from(0.0, minute_ms), {{"device", -1.0}});
  if (line_period_ms >= 0.0) {
    device.line_period = std::chrono::nanoseconds(static_cast<std::int64_t>(1e6 * line_period_ms));
  }
}

void read_micron_acoustics(YamlSection& section, HeadConfig& head, MicronConfig& config) {
  read_acoustics(section, micron::carrier_hz, head);
  double beamwidth_deg = head.acoustics.aperture.receive_beamwidth_rad / degree;
  section.number("beamwidth_deg", beamwidth_deg, Range::above(0.0, 60.0));
  head.acoustics.aperture.receive_beamwidth_rad = beamwidth_deg * degree;
  head.acoustics.aperture.beam_edges_rad = {beamwidth_deg * degree / 2, -beamwidth_deg * degree / 2};
  section.number("nominal_gain_db", config.nominal_gain_db, Range::from(0.0, 80.0));
  using Pulse = render::PhysicalModel::Pulse;
  section.choice(
      "pulse", head.acoustics.physical.pulse,
      {{"chirp", Pulse::chirp}, {"windowed_chirp", Pulse::windowed_chirp}, {"point", Pulse::point}});
  double chirp_bandwidth_khz = config.chirp_bandwidth_hz / 1000.0;
  section.number("chirp_bandwidth_khz", chirp_bandwidth_khz, Range::from(0.0, 10'000.0));
  config.chirp_bandwidth_hz = chirp_bandwidth_khz * 1000.0;
}

}  // namespace

MicronConfig read_micron_head(YamlSection& section, const HeadContext& context, HeadConfig& head,
                              std::vector<ConfigWarning>& warnings) {
  MicronConfig config;
  apply_water(context, micron::carrier_hz, head, warnings);
  // What turns its times into ranges; hosts reckon with 1500 m/s (docs/protocols/micron.md 4).
  config.device.waits_for_permission = context.pings_by_source;
  if (context.water_sound_speed_mps > 0.0) {
    config.device.water_sound_speed_mps = context.water_sound_speed_mps;
  }
  read_common(section, context, head);
  section.require("serial", "a mapping with tcp, udp or pty");
  section.section("serial",
                  [&](YamlSection& inner) { config.serial = read_serial_link(inner, context.folder); });
  section.section("device", [&](YamlSection& inner) { read_device(inner, config.device); });
  section.section("timing", [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("acoustics", [&](YamlSection& inner) { read_micron_acoustics(inner, head, config); });
  return config;
}

}  // namespace sonard::server
