// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping1d/section.hpp"

#include <algorithm>
#include <charconv>
#include <string>

#include "server/devices/ping/section.hpp"

namespace sonard::server {
namespace {

constexpr TextForm length_form{"a length in metres from 1 to 100", "lengths",
                               R"("type": "number", "minimum": 1, "maximum": 100)"};

std::optional<double> parse_length(std::string_view text) {
  double metres = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), metres);
  const bool number = error == std::errc{} && end == text.data() + text.size();
  return number && metres >= 1.0 && metres <= 100.0 ? std::optional(metres) : std::nullopt;
}

void read_device(YamlSection& section, ping1d::DeviceConfig& device) {
  read_identity(section, 0, "hardware revision that the head reports: 1 Ping1D, 2 Ping2",
                "minor version of the firmware; a hardware test expects 27 or above", device.id,
                device.information);
  section.default_is("revision", "set by `model`");
  section.integer("voltage_mv", device.voltage_mv, 0, 65'535, "supply voltage that the head reports");
  section.integer("processor_temperature_cdeg", device.processor_temperature_cdeg, 0, 65'535,
                  "temperature of the processor that the head reports, in hundredths of a degree Celsius");
  section.integer("pcb_temperature_cdeg", device.pcb_temperature_cdeg, 0, 65'535,
                  "temperature of the board that the head reports, in hundredths of a degree Celsius");
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
  read_receivers(section, "started the stream", device);
}

void read_timing(YamlSection& section, ping1d::DeviceConfig& device) {
  section.duration("ping_overhead_ms", device.ping_overhead, Range::from(0.0, 10'000.0),
                   "overhead of each ping, in addition to listening");
  read_time_scale(section, device.time_scale);
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
      "([messages](../protocol/ping1d/README.md)). Its one beam looks along the x axis of its mount: "
      "`rpy_deg: [0, 90, 0]` is straight down.");
  Ping1dConfig config;
  Ping1dModel model = Ping1dModel::ping1d;
  section.choice("model", model, {{"ping1d", Ping1dModel::ping1d}, {"ping2", Ping1dModel::ping2}},
                 "model of the device; it sets beam, least range and revision");
  head.acoustics = ping1d_acoustics(model);
  config.device.information.device_revision = model == Ping1dModel::ping1d ? 1 : 2;
  config.device.least_range_m = head.acoustics.physical.ring_down.end_m;
  apply_water(section, context, ping1d::carrier_hz, head);
  apply_context(context, config.device);
  read_common(section, context, head);
  read_lines(section, context, "UDP address; port 9090: a vehicle's bridge to the first such head", config,
             config.device);
  section.section("device",
                  "identity that the head reports, and behaviour that differs between firmware and clients",
                  [&](YamlSection& inner) { read_device(inner, config.device); });
  section.section("timing", "pace of pings, silence, restarts",
                  [&](YamlSection& inner) { read_timing(inner, config.device); });
  section.section("acoustics", "formation of the pings",
                  [&](YamlSection& inner) { read_ping1d_acoustics(inner, head, config); });
  check_lock(section, config.device);
  return config;
}

}  // namespace sonard::server
