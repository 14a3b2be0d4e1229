// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/scan_settings.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

#include "protocol/micron/units.hpp"

namespace sonard::micron {
namespace {

std::uint8_t level(double db) {
  return static_cast<std::uint8_t>(std::lround(db * 255.0 / full_scale_db));
}

void assign(std::uint16_t& control, std::uint16_t bit, bool on) {
  control = static_cast<std::uint16_t>(on ? control | bit : control & ~bit);
}

}  // namespace

int ad_interval(const ScanSettings& settings) {
  const double wanted_s = 2.0 * settings.range_m / (settings.sound_speed_mps * settings.bins);
  constexpr double rounding = 1e-9;  // for ranges that were computed from an interval
  return static_cast<int>(wanted_s / bin_time_s(1) + rounding);
}

HeadCommand make_head_command(const ScanSettings& settings) {
  namespace bits = control_bits;
  HeadCommand command;
  assign(command.control, bits::eight_bit, settings.eight_bit);
  assign(command.control, bits::continuous, !settings.sector);
  assign(command.control, bits::scan_right, settings.clockwise);
  command.range_scale = static_cast<std::uint16_t>(std::lround(10.0 * settings.range_m));
  if (settings.sector) {
    command.left_limit = static_cast<std::uint16_t>(settings.sector->left);
    command.right_limit = static_cast<std::uint16_t>(settings.sector->right);
  }
  command.ad_low = level(settings.ad_low_db);
  command.ad_span = level(settings.ad_span_db);
  const auto gain = static_cast<std::uint8_t>(std::lround(settings.gain_percent * gain_full_scale / 100.0));
  command.gain = {gain, gain};
  command.step = static_cast<std::uint8_t>(settings.step);
  command.ad_interval = static_cast<std::uint16_t>(ad_interval(settings));
  command.bins = static_cast<std::uint16_t>(settings.bins);
  return command;
}

double bin_length_m(const ScanSettings& settings) {
  return bin_time_s(ad_interval(settings)) * settings.sound_speed_mps / 2.0;
}

double covered_range_m(const ScanSettings& settings) {
  return settings.bins * bin_length_m(settings);
}

double bearing_deg(int bearing) {
  return bearing_rad(bearing) * 180.0 / std::numbers::pi;
}

int bearing_of_degrees(double degrees) {
  return wrapped(bearing_ahead + static_cast<int>(std::lround(degrees / step_unit_deg)));
}

std::optional<int> step_of_degrees(double degrees) {
  constexpr double rounding = 1e-3;  // units
  const double units = degrees / step_unit_deg;
  const double whole = std::round(units);
  if (!(whole >= 1.0 && whole <= most_step) || std::abs(units - whole) > rounding) {
    return std::nullopt;
  }
  return static_cast<int>(whole);
}

}  // namespace sonard::micron
