// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/micron/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "protocol/micron/units.hpp"

namespace sonard::client {
namespace {

constexpr int most_ad_interval = 65'535;

int step_of(double degrees) {
  if (const std::optional<int> step = micron::step_of_degrees(degrees)) {
    return *step;
  }
  constexpr double unit_deg = micron::step_unit_deg;
  const double nearest = std::clamp(std::round(degrees / unit_deg), 1.0, 1.0 * micron::most_step);
  throw CLI::ValidationError(
      "--step", fmt::format("expected a multiple of {} degrees, {} at most, found {}; the nearest is {}",
                            unit_deg, micron::most_step * unit_deg, degrees, nearest * unit_deg));
}

micron::ScanSector sector_of(const std::vector<double>& from_to_deg) {
  const micron::ScanSector sector{micron::bearing_of_degrees(from_to_deg[0]),
                                  micron::bearing_of_degrees(from_to_deg[1])};
  if (sector.left == sector.right) {
    throw CLI::ValidationError("--sector", "FROM and TO are equal; omit --sector to scan all round");
  }
  return sector;
}

}  // namespace

MicronArguments::MicronArguments(CLI::App& app) {
  declare_link(app);
  declare_sonar(app);
  declare_run(app);
}

void MicronArguments::declare_link(CLI::App& app) {
  constexpr const char* group = LinkArguments::group;
  link_.declare(app);
  app.add_option("--node", node_, "Node address of the head")
      ->check(CLI::Range(1, 254))
      ->capture_default_str()
      ->group(group);
  app.add_flag("--reboot", options_.client.reboot_first,
               "Reboot the head first, which resets all its settings")
      ->group(group);
}

void MicronArguments::declare_sonar(CLI::App& app) {
  micron::ScanSettings& scan = options_.scan;
  const auto add = [&](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->capture_default_str()->group("Sonar");
  };
  add("--range", scan.range_m, "Range in metres; the head covers this or a little less")
      ->check(CLI::Range(0.1, 200.0));
  add("--bins", scan.bins, "Bins per line")->check(CLI::Range(1, micron::max_bins));
  add("--step", step_deg_, "Degrees from line to line, a multiple of 0.05625 (1/16 gradian)");
  app.add_option("--sector", sector_deg_,
                 "FROM TO: scan back and forth between these bearings, in degrees, 0 ahead, positive to "
                 "starboard; the sector lies clockwise from FROM to TO. Default: all round")
      ->expected(2)
      ->check(CLI::Range(-360.0, 360.0))
      ->group("Sonar");
  app.add_flag("--scan-left", scan_left_, "Scan counter-clockwise; in a sector: begin counter-clockwise")
      ->group("Sonar");
  add("--gain", scan.gain_percent, "Initial gain, percent")->check(CLI::Range(0.0, 100.0));
  CLI::Option* four_bit =
      app.add_flag("--four-bit", four_bit_,
                   "4-bit bins over the window --ad-low, --ad-span; default: 8-bit bins, 0..80 dB")
          ->group("Sonar");
  add("--ad-low", scan.ad_low_db, "Lower end of the window, dB")
      ->check(CLI::Range(0.0, 80.0))
      ->needs(four_bit);
  add("--ad-span", scan.ad_span_db, "Width of the window, dB")->check(CLI::Range(0.0, 80.0))->needs(four_bit);
  add("--sound-speed", scan.sound_speed_mps, "Sound speed in metres per second, to convert times to ranges")
      ->check(CLI::Range(1300.0, 1700.0));
}

void MicronArguments::declare_run(CLI::App& app) {
  run_.declare(app, {.ping = "line", .picture = "turn", .link_group = LinkArguments::group});
  app.add_option("--turns", options_.sweeps,
                 "End after this many turns, or sweeps of the sector; 0: no limit")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str()
      ->group("Run");
  app.add_option("--raw", options_.raw, "File for the lines as received, one JSON object per line")
      ->group("Run");
}

micron::ScanSettings MicronArguments::scan() const {
  micron::ScanSettings scan = options_.scan;
  scan.step = step_of(step_deg_);
  if (!sector_deg_.empty()) {
    scan.sector = sector_of(sector_deg_);
  }
  scan.clockwise = !scan_left_;
  scan.eight_bit = !four_bit_;
  if (const int interval = micron::ad_interval(scan); interval < 1 || interval > most_ad_interval) {
    throw CLI::ValidationError(
        "--bins", fmt::format("{} bins over {} m are too {} for a head, which supports 1 to {} times 640 ns "
                              "between bins",
                              scan.bins, scan.range_m, interval < 1 ? "fine" : "coarse", most_ad_interval));
  }
  return scan;
}

MicronOptions MicronArguments::options() const {
  MicronOptions options = options_;
  options.line = link_.address();
  options.client.node = static_cast<std::uint8_t>(node_);
  options.scan = scan();
  options.run = run_.options();
  return options;
}

}  // namespace sonard::client
