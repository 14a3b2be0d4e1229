// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/ping_plan.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace sonard::gemini {

namespace {

constexpr int min_native_lines = 32;
constexpr int max_native_lines_8_bit = 20'000;
constexpr int max_native_lines_16_bit = 10'000;

// The grid of the device: 1400 + 3.2 k m/s, k = 0..59.
constexpr double grid_base_mps = 1400.0;
constexpr double grid_step_mps = 3.2;
constexpr double grid_top_mps = grid_base_mps + 59 * grid_step_mps;

int most_lines(const PingConfig& config) {
  return config.eight_bit() ? max_native_lines_8_bit : max_native_lines_16_bit;
}

double configured_speed_mps(const PingConfig& config) {
  return std::clamp(config.sound_speed_mps(), grid_base_mps, grid_top_mps);
}

std::vector<Setting> settings_of(const PingJob& job) {
  std::vector<Setting> settings{{"range", fmt::format("{:.2f}m", job.range_m())},
                                {"lines", fmt::format("{}", job.bins())},
                                {"compression", fmt::format("x{}", 1 << job.compression_log2)},
                                {"gain", fmt::format("{:+.1f}dB", job.gain_db)},
                                {"sound_speed", fmt::format("{:.1f}m/s", job.sound_speed_mps)},
                                {"bits", job.sixteen_bit ? "16" : "8"}};
  if (!job.transmit) {
    settings.push_back({"transmit", "off"});
  }
  return settings;
}

PingJob make_job(const PingConfig& config, const DeviceConfig& device) {
  PingJob job;
  job.sixteen_bit = !config.eight_bit();
  job.native_bins = std::clamp<int>(config.end_range, min_native_lines, most_lines(config));
  job.compression_log2 = config.compression_log2();
  job.sound_speed_mps =
      device.water_sound_speed_mps > 0.0 ? device.water_sound_speed_mps : configured_speed_mps(config);
  job.assumed_sound_speed_mps =
      config.uses_configured_sound_speed() ? configured_speed_mps(config) : job.sound_speed_mps;
  job.native_bin_m = job.sound_speed_mps / (2.0 * line_rate_hz);
  job.pulse_s = config.tx_length / carrier_hz;
  job.transmit = config.tx_length != 0;
  job.gain_db = receive_gain_db(config.main_gain, config.spreading, device.gain);
  job.gain_percent = gain_percent(config.spreading);
  job.listening_time = acoustic_time(job.native_bins);
  job.settings = settings_of(job);
  return job;
}

PingHead make_head(const PingConfig& config, const PingJob& job, const DeviceConfig& device) {
  PingHead head;
  head.header.sonar_id = device.sonar_id;
  head.ext_mode = config.ext_mode;
  head.end_range = static_cast<std::uint16_t>(job.native_bins);
  head.sample_channel = static_cast<std::uint8_t>(config.sample_channel & 0xFF);
  head.base_gain = static_cast<std::uint8_t>(config.main_gain >> 14);
  head.velocimeter_speed = speed_code(job.sound_speed_mps, device.snap_sound_speed);
  head.sound_speed_used =
      config.uses_configured_sound_speed()
          ? static_cast<std::uint16_t>(sound_speed_from_config |
                                       speed_code(configured_speed_mps(config), device.snap_sound_speed))
          : head.velocimeter_speed;
  head.rle_threshold = config.rle_threshold_applied();
  head.range_compression = static_cast<std::uint8_t>(job.compression_log2);
  return head;
}

}  // namespace

std::uint16_t speed_code(double speed_mps, bool snap) {
  if (snap) {
    const double step = std::round((speed_mps - grid_base_mps) / grid_step_mps);
    speed_mps = grid_base_mps + std::clamp(step, 0.0, 59.0) * grid_step_mps;
  }
  return static_cast<std::uint16_t>(std::clamp(std::lround(speed_mps * 10.0), 1L, 0x7FFFL));
}

std::chrono::nanoseconds acoustic_time(int native_lines) {
  return std::chrono::nanoseconds{static_cast<std::int64_t>(std::ceil(native_lines * 1e9 / line_rate_hz))};
}

std::optional<PingPlan> plan_ping(const PingConfig& config, const DeviceConfig& device) {
  if (config.data_type() != DataType::beam_magnitude || config.mode() == RunMode::reserved) {
    return std::nullopt;
  }
  PingPlan plan;
  plan.mode = config.mode();
  plan.pings_out_of_water = config.pings_out_of_water();
  plan.interval = std::chrono::microseconds{config.interping_us};
  plan.job = make_job(config, device);
  plan.rle_threshold = config.rle_threshold_applied();
  plan.head = make_head(config, plan.job, device);
  plan.line_scale = static_cast<std::uint16_t>(config.software_gain & 0xFFFF);
  return plan;
}

bool PingConfigWarnings::check(const PingConfig& config, std::vector<Notice>& notices) {
  bool clamped = false;
  const auto clamp = [&](std::string_view field, long value, long least, long most) {
    if (value < least || value > most) {
      warnings_.warn(field,
                     fmt::format("the client's {} {} is out of range: the head uses {} to {}", field, value,
                                 least, most),
                     notices);
      clamped = true;
    }
  };
  clamp("end_range", config.end_range, min_native_lines, most_lines(config));
  if (config.uses_configured_sound_speed()) {
    clamp("sound_speed", config.sound_speed, std::lround(grid_base_mps * 10.0),
          std::lround(grid_top_mps * 10.0));
  }
  return clamped;
}

}  // namespace sonard::gemini
