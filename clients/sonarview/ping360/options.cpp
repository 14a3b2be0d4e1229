// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/ping360/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>

#include "protocol/ping360/units.hpp"
#include "protocol/ping360/usual_scan.hpp"

namespace sonard::client {
Ping360Arguments::Ping360Arguments(CLI::App& app) {
  link_.declare(app);
  declare_sonar(app);
  run_.declare(app, {.picture = "turn", .link_group = LinkArguments::group});
  app.add_option("--turns", options_.turns, "End after this many turns, or sweeps of the sector; 0: no limit")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str()
      ->group("Run");
}

void Ping360Arguments::declare_sonar(CLI::App& app) {
  const auto add = [&](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->capture_default_str()->group("Sonar");
  };
  add("--range", range_m_, "Range in metres; the head covers this or a little less")
      ->check(CLI::Range(0.5, 100.0));
  add("--samples", samples_, "Samples per ping, 200 to 1200; 0: as many as the range allows")
      ->check(CLI::Range(200, 1200) | CLI::IsMember({0}));
  add("--step", step_, "Gradians (0.9 degrees) from ping to ping")->check(CLI::Range(1, 10));
  add("--gain", gain_, "Gain: 0 low, 1 normal, 2 high")->check(CLI::Range(0, 2));
  add("--frequency", frequency_khz_, "Frequency in kHz")->check(CLI::Range(500, 1000));
  add("--sound-speed", options_.sound_speed_mps,
      "Sound speed in metres per second, to convert times to ranges")
      ->check(CLI::Range(1300.0, 1700.0));
  add("--ahead", options_.ahead, "Angle in gradians at which the head looks straight ahead")
      ->check(CLI::Range(0, 399));
  app.add_flag("--auto", options_.automatic, "Let the head scan by itself, instead of requesting each ping")
      ->group("Sonar");
  app.add_option("--sector", sector_deg_,
                 "FROM TO: let the head scan this sector by itself, in degrees, 0 ahead, positive to "
                 "starboard, clockwise from FROM to TO. Default: all round")
      ->expected(2)
      ->check(CLI::Range(-360.0, 360.0))
      ->group("Sonar");
  add("--delay", delay_ms_, "Additional milliseconds between two pings of --auto")->check(CLI::Range(0, 100));
}

void Ping360Arguments::set_scan(Ping360Options& options) const {
  const auto samples = samples_ > 0 ? std::optional(samples_) : std::nullopt;
  const auto usual = ping360::usual_scan(range_m_, samples, options.sound_speed_mps, options.ahead);
  if (!usual) {
    throw CLI::ValidationError(
        "--samples", fmt::format("{} samples over {} m are too fine for a head", samples_, range_m_));
  }
  ping360::AutoTransmit& scan = options.scan;
  scan = *usual;
  scan.gain_setting = static_cast<std::uint8_t>(gain_);
  scan.transmit_frequency_khz = static_cast<std::uint16_t>(frequency_khz_);
  scan.num_steps = static_cast<std::uint8_t>(step_);
  scan.delay_ms = static_cast<std::uint8_t>(delay_ms_);
  if (sector_deg_.empty()) {
    return;
  }
  scan.start_angle = static_cast<std::uint16_t>(ping360::angle_of(sector_deg_[0], options.ahead));
  scan.stop_angle = static_cast<std::uint16_t>(ping360::angle_of(sector_deg_[1], options.ahead));
  if (scan.start_angle == scan.stop_angle) {
    throw CLI::ValidationError("--sector", "FROM and TO are equal; omit --sector to scan all round");
  }
  options.all_round = false;
  options.automatic = true;
}

Ping360Options Ping360Arguments::options() const {
  Ping360Options options = options_;
  options.line = link_.address();
  set_scan(options);
  options.run = run_.options();
  return options;
}

}  // namespace sonard::client
