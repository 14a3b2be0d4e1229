// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/ping1d/options.hpp"

#include <CLI/CLI.hpp>
#include <cmath>

namespace sonard::client {
namespace {

std::uint32_t thousandths(double value) {
  return static_cast<std::uint32_t>(std::lround(1e3 * value));
}

}  // namespace

Ping1dArguments::Ping1dArguments(CLI::App& app) {
  link_.declare(app);
  const auto add = [&](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->capture_default_str()->group("Sonar");
  };
  add("--range", range_m_, "Length of the scan in metres; 0: the head chooses range and gain")
      ->check(CLI::Range(1.0, 100.0) | CLI::IsMember({0}));
  add("--start", start_m_, "Start of the scan in metres, with --range")->check(CLI::Range(0.0, 100.0));
  add("--gain", gain_, "Gain, 0 to 6, with --range; -1: as it is")->check(CLI::Range(-1, 6));
  add("--interval", interval_ms_, "Least milliseconds from ping to ping")->check(CLI::Range(0, 65'535));
  add("--sound-speed", sound_speed_mps_, "Sound speed in metres per second, which the head uses")
      ->check(CLI::Range(1300.0, 1700.0));
  run_.declare(app, {.link_group = LinkArguments::group});
}

Ping1dOptions Ping1dArguments::options() const {
  const bool automatic = range_m_ == 0.0;
  if (automatic && (start_m_ > 0.0 || gain_ >= 0)) {
    throw CLI::ValidationError(gain_ >= 0 ? "--gain" : "--start", "needs --range");
  }
  Ping1dOptions options;
  options.line = link_.address();
  options.run = run_.options();
  options.settings = {ping1d::SetPingEnable{1},
                      ping1d::SetPingInterval{static_cast<std::uint16_t>(interval_ms_)},
                      ping1d::SetSpeedOfSound{thousandths(sound_speed_mps_)},
                      ping1d::SetModeAuto{automatic ? std::uint8_t{1} : std::uint8_t{0}}};
  if (!automatic) {
    options.settings.emplace_back(ping1d::SetRange{thousandths(start_m_), thousandths(range_m_)});
  }
  if (gain_ >= 0) {
    options.settings.emplace_back(ping1d::SetGainSetting{static_cast<std::uint8_t>(gain_)});
  }
  return options;
}

}  // namespace sonard::client
