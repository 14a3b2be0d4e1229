// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/settings_text.hpp"

#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "protocol/micron/line_timing.hpp"
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

bool SettingsWarnings::check_gain(int gain, std::vector<Notice>& notices) {
  if (gain <= gain_full_scale) {
    return false;
  }
  warnings_.warn(
      "gain", fmt::format("the client's gain byte {} is beyond 210, the maximum: the head uses 80 dB", gain),
      notices);
  return true;
}

bool SettingsWarnings::check_bins(const HeadCommand& parameters, std::vector<Notice>& notices) {
  const int bins = effective_bins(parameters);
  const int interval = effective_ad_interval(parameters);
  if (bins != parameters.bins) {
    warnings_.warn("bins",
                   fmt::format("the client requests {} bins (expected 1 to {}): the head uses {}",
                               parameters.bins, max_bins, bins),
                   notices);
  }
  if (interval != parameters.ad_interval) {
    warnings_.warn("ad_interval", "the client's ad_interval is 0: the head uses 1", notices);
  }
  return bins != parameters.bins || interval != parameters.ad_interval;
}

bool SettingsWarnings::check(const HeadCommand& parameters, std::vector<Notice>& notices) {
  namespace bits = control_bits;
  const bool told_to = parameters.has(bits::stare) || parameters.has(bits::motor_off);
  if (stares(parameters) && !told_to) {
    warnings_.warn(
        "limits",
        fmt::format("the client's sector has equal limits ({}): the head holds still there; a whole "
                    "turn is 0 to 6400",
                    parameters.left_limit),
        notices);
  }
  if (parameters.has(bits::invert) != config_.mounted_inverted) {
    warnings_.warn(
        "mounting",
        fmt::format("left and right are swapped: the client's invert bit is for a head mounted boot "
                    "{}, `device.mounted_inverted` for one mounted boot {}",
                    parameters.has(bits::invert) ? "down" : "up", config_.mounted_inverted ? "down" : "up"),
        notices);
  }
  const bool clamps_gain = check_gain(parameters.gain[0], notices);
  const bool clamps_bins = check_bins(parameters, notices);
  return clamps_gain || clamps_bins;
}

}  // namespace sonard::micron
