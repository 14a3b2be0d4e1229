// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/ping_settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sonard::gemini {
namespace {

constexpr double max_range_m = 150.0;
constexpr double min_lines = 32.0;
constexpr double max_lines_8_bit = 20'000.0;
constexpr double max_lines_16_bit = 10'000.0;

std::uint16_t range_lines(double range_m, double sound_speed_mps, bool sixteen_bit) {
  const double line_step_m = sound_speed_mps / 2.0 / line_rate_hz;
  const double lines = std::floor(std::min(range_m, max_range_m) / line_step_m + 0.5);
  return static_cast<std::uint16_t>(
      std::clamp(lines, min_lines, sixteen_bit ? max_lines_16_bit : max_lines_8_bit));
}

/// Longer pulses put more energy into far echoes.
std::uint16_t pulse_cycles(double range_m) {
  if (range_m < 10.0) {
    return 4;
  }
  if (range_m < 50.0) {
    return static_cast<std::uint16_t>(4.0 + std::floor(28.0 * (range_m - 10.0) / 40.0));
  }
  if (range_m < 100.0) {
    return static_cast<std::uint16_t>(32.0 + std::floor(96.0 * (range_m - 50.0) / 50.0));
  }
  return 128;
}

/// Receive bandwidth follows the pulse: bank 7 is the widest.
std::uint16_t filter_bank(double range_m) {
  constexpr std::array below_m{50.0, 40.0, 30.0, 25.0, 20.0, 15.0, 10.0};
  std::uint16_t bank = 0;
  for (const double limit_m : below_m) {
    bank = static_cast<std::uint16_t>(bank + (range_m < limit_m ? 1 : 0));
  }
  return bank;
}

}  // namespace

PingConfig make_ping_config(const PingSettings& settings) {
  const double sound_speed_mps = std::clamp(settings.sound_speed_mps, 1400.0, 1588.0);
  const double gain_percent = std::clamp(settings.gain_percent, 0.0, 100.0);
  PingConfig config;
  config.run_mode = static_cast<std::uint16_t>(settings.interval ? RunMode::continuous : RunMode::single);
  config.ext_mode = static_cast<std::uint16_t>(ext_bits::ping_out_of_water |
                                               (settings.sixteen_bit ? 0U : unsigned{ext_bits::eight_bit}));
  config.end_range = range_lines(settings.range_m, sound_speed_mps, settings.sixteen_bit);
  if (settings.interval) {
    config.interping_us = static_cast<std::uint32_t>(
        std::clamp<std::int64_t>(settings.interval->count(), 0, std::numeric_limits<std::uint32_t>::max()));
  }
  config.tx_length = pulse_cycles(settings.range_m);
  config.main_gain = settings.range_m < 5.0 ? 0x83E8 : 0xC3E8;
  config.software_gain = 0x1E00;
  config.spreading = static_cast<std::uint16_t>(500.0 * std::exp((gain_percent - 100.0) / 25.0));
  config.filter_bank = filter_bank(settings.range_m);
  config.sound_speed = static_cast<std::uint16_t>(std::lround(10.0 * sound_speed_mps));
  config.velocimeter_mode = 1;  // use the speed above, because range_m was converted with it
  config.range_compression = static_cast<std::uint16_t>(std::clamp(settings.compression_log2, 0, 4));
  config.rle_threshold = static_cast<std::uint16_t>(std::clamp(settings.rle_threshold, 0, 255));
  config.software_gain_ramp = 18;
  return config;
}

}  // namespace sonard::gemini
