// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/settings_text.hpp"

#include <utility>

#include <fmt/format.h>

#include "protocol/micron/scan_settings.hpp"
#include "protocol/micron/sweep.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::micron {
namespace {

std::vector<Setting> ping_settings(const PingJob& job, int ad_low, int ad_span, bool eight_bit) {
  std::vector<Setting> settings{
      {"range", fmt::format("{:.2f}m", job.range_m())},
      {"bins", fmt::format("{}", job.bins())},
      {"bin", fmt::format("{:.1f}mm", 1e3 * job.bin_m())},
      {"gain", fmt::format("{:.1f}dB", job.gain_db)},
      {"window", fmt::format("{:.1f}+{:.1f}dB", level_db(ad_low), level_db(ad_span))},
      {"bits", eight_bit ? "8" : "4"}};
  if (!job.transmit) {
    settings.push_back({"transmit", "off"});
  }
  return settings;
}

std::string degrees_text(int bearing) {
  return fmt::format("{:.2f}deg", bearing_deg(bearing));
}

void add_scan(const HeadCommand& parameters, LimitsOrder order, std::vector<Setting>& settings) {
  namespace bits = control_bits;
  const Sector sector = sector_of(parameters, order);
  if (parameters.has(bits::motor_off)) {
    settings.push_back({"scan", "motor_off"});
    return;
  }
  if (stares(parameters)) {
    settings.push_back({"scan", "stares"});
    settings.push_back({"at", degrees_text(sector.left)});
    return;
  }
  if (parameters.has(bits::continuous)) {
    settings.push_back({"scan", "all_round"});
  } else if (sector.width == units_per_turn) {
    settings.push_back({"scan", "sector_all_round"});
  } else {
    settings.push_back({"scan", "sector"});
    settings.push_back({"from", degrees_text(sector.left)});
    settings.push_back({"to", degrees_text(sector.right())});
  }
  const int step = parameters.step == 0 ? step_of_zero : parameters.step;
  settings.push_back({"step", fmt::format("{:.2f}deg", step_unit_deg * step)});
  settings.push_back({"direction", parameters.has(bits::scan_right) ? "right" : "left"});
}

}  // namespace

std::vector<Setting> settings_of(const PingJob& job, const HeadCommand& parameters,
                                 const DeviceConfig& config) {
  std::vector<Setting> settings =
      ping_settings(job, parameters.ad_low, parameters.ad_span, parameters.has(control_bits::eight_bit));
  add_scan(parameters, config.limits_order, settings);
  settings.push_back({"inverted", parameters.has(control_bits::invert) ? "yes" : "no"});
  return settings;
}

std::vector<Setting> settings_of(const PingJob& job, const HeadData& line) {
  return ping_settings(job, line.ad_low, line.ad_span, line.eight_bit());
}

void SettingsWarnings::check(const HeadCommand& parameters, std::vector<Notice>& notices) {
  namespace bits = control_bits;
  const auto warn = [&](std::string text) { notices.push_back({Notice::Level::warning, std::move(text)}); };
  if (parameters.gain[0] > gain_full_scale && !std::exchange(said_gain_, true)) {
    warn(fmt::format("the client's gain byte {} is beyond 210, the maximum: the head uses 80 dB",
                     parameters.gain[0]));
  }
  const bool told_to = parameters.has(bits::stare) || parameters.has(bits::motor_off);
  if (stares(parameters) && !told_to && !std::exchange(said_limits_, true)) {
    warn(fmt::format(
        "the client's sector has equal limits ({}): the head holds still there; a whole turn is 0 to 6400",
        parameters.left_limit));
  }
  if (parameters.has(bits::invert) != config_.mounted_inverted && !std::exchange(said_mirrored_, true)) {
    warn(
        fmt::format("left and right are swapped: the client's invert bit is for a head mounted boot {}, "
                    "`device.mounted_inverted` for one mounted boot {}",
                    parameters.has(bits::invert) ? "down" : "up", config_.mounted_inverted ? "down" : "up"));
  }
}

}  // namespace sonard::micron
