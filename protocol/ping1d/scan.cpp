// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/scan.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace sonard::ping1d {
namespace {

using std::chrono::nanoseconds;

constexpr double samples_per_point = 10.0;
constexpr double most_samples = 8000.0;  // so that a short scan far away is not too fine to render
constexpr std::array<double, most_gain + 1> gains{0.6, 1.8, 5.5, 12.9, 30.2, 66.1, 144.0};
constexpr nanoseconds least_period{20'000'000};

}  // namespace

Samples samples_of(const Scan& scan, int points) {
  const double step_mm =
      std::max(scan.length_mm / (samples_per_point * points), scan.end_mm() / most_samples);
  return {static_cast<int>(std::ceil(scan.end_mm() / step_mm - 1e-9)), step_mm};
}

double gain_db(std::uint8_t setting) {
  return 20.0 * std::log10(gains.at(setting));
}

std::uint16_t transmit_duration_us(const Scan& scan, const DeviceConfig& config) {
  return static_cast<std::uint16_t>(
      std::clamp(std::round(config.pulse_us_per_m * 1e-3 * scan.length_mm), 20.0, 1000.0));
}

nanoseconds listening_time(const Scan& scan) {
  return nanoseconds{static_cast<std::int64_t>(2e9 * scan.end_mm() / scan.speed_of_sound_mmps)};
}

nanoseconds ping_period(const Scan& scan, std::uint16_t interval_ms, const DeviceConfig& config) {
  const nanoseconds listening = listening_time(scan);
  const nanoseconds period = std::max(
      {nanoseconds{std::chrono::milliseconds{interval_ms}}, listening + config.ping_overhead, least_period});
  return std::max(listening, nanoseconds{static_cast<std::int64_t>(static_cast<double>(period.count()) *
                                                                   config.time_scale)});
}

/// The head's millimetres are longer or shorter than true ones if its speed of sound is wrong.
PingJob make_job(const Scan& scan, const DeviceConfig& config) {
  const Samples samples = samples_of(scan, config.points);
  PingJob job;
  job.native_bins = samples.count;
  job.native_bin_m = 1e-3 * samples.step_mm * config.water_sound_speed_mps / scan.sound_speed_mps();
  job.listening_time = listening_time(scan);
  job.sixteen_bit = true;
  job.sound_speed_mps = config.water_sound_speed_mps;
  job.pulse_s = 1e-6 * transmit_duration_us(scan, config);
  job.gain_db = gain_db(scan.gain);
  job.gain_percent = 100.0 * scan.gain / most_gain;
  job.settings = {{"start", fmt::format("{:.2f}m", 1e-3 * scan.start_mm)},
                  {"length", fmt::format("{:.2f}m", 1e-3 * scan.length_mm)},
                  {"gain", fmt::format("{}", scan.gain)},
                  {"pulse", fmt::format("{}us", transmit_duration_us(scan, config))},
                  {"sound_speed", fmt::format("{:.1f}m/s", scan.sound_speed_mps())}};
  return job;
}

}  // namespace sonard::ping1d
