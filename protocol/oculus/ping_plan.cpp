// SPDX-License-Identifier: Apache-2.0
#include "protocol/oculus/ping_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "protocol/common/byte_writer.hpp"

namespace sonard::oculus {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr double percent = 0.01;
constexpr double bar_per_m = 0.1;      // within 2 % of fresh water and sea water
constexpr std::uint32_t row_gain = 1;  // must not be 0: clients divide by it (4.7)

nanoseconds seconds(double value) {
  return nanoseconds{std::llround(value * 1e9)};
}

double range_of(const Fire& fire, const Mode& mode) {
  const bool metres = (fire.flags & fire_flags::range_in_metres) != 0;
  const double range_m = metres ? fire.range : fire.range * percent * mode.most_range_m;
  return std::isfinite(range_m) ? std::clamp(range_m, least_range_m, mode.most_range_m) : least_range_m;
}

double sound_speed_of(const Fire& fire, const PlanConfig& config) {
  const double salinity = std::isfinite(fire.salinity_ppt) ? fire.salinity_ppt : 0.0;
  const bool given = std::isfinite(fire.sound_speed_mps) && fire.sound_speed_mps != 0.0;
  const double speed =
      given ? fire.sound_speed_mps : sound_speed_of_water_mps(config.temperature_c, salinity);
  return std::clamp(speed, least_sound_speed_mps, most_sound_speed_mps);
}

nanoseconds time_on_link(const PingPlan& plan) {
  const int megabits = plan.result.fire.fire.network_speed;
  if (megabits == 0 || megabits == 0xFF) {
    return nanoseconds{0};
  }
  const double bits = 8.0 * static_cast<double>(plan.result.image_offset + plan.image_size());
  return seconds(bits / (megabits * 1e6));
}

}  // namespace

std::optional<nanoseconds> period_of_rate(std::uint8_t ping_rate) {
  switch (ping_rate) {
    case 1:
      return nanoseconds{1'000'000'000 / 15};
    case 2:
      return milliseconds{25};
    case 3:
      return milliseconds{200};
    case 4:
      return milliseconds{500};
    case 5:
      return std::nullopt;
    default:
      return milliseconds{100};
  }
}

PingPlan plan_ping(const SimpleFire& fire, const PlanConfig& config) {
  const Mode& mode = config.model.mode(fire.fire.master_mode);
  PingPlan plan;
  plan.asked = fire;
  PingResult& ping = plan.result;
  ping.fire = fire;
  if (fire.extension) {
    ping.fire.version = 2;
  } else {
    ping.fire.version = fire.version == 1 || config.reports_version_1 ? 1 : 0;
  }
  ping.sound_speed_mps = sound_speed_of(fire.fire, config);
  if (fire.fire.sound_speed_mps == 0.0 && config.reports_sound_speed_used) {
    ping.fire.fire.sound_speed_mps = ping.sound_speed_mps;
  }
  if (config.rescales_high_frequency_gain) {
    ping.fire.fire.gain_percent = reported_gain_percent(fire.fire);
  }
  plan.range_m = range_of(fire.fire, mode);
  const RangeGrid grid = range_grid(plan.range_m, ping.sound_speed_mps, config.most_ranges);
  ping.frequency_hz = mode.frequency_hz;
  ping.temperature_c = config.temperature_c;
  ping.pressure_bar = config.pressure_bar;
  ping.data_size = data_size_of(fire);
  ping.range_resolution_m = grid.resolution_m;
  ping.ranges = static_cast<std::uint16_t>(grid.ranges);
  ping.beams = static_cast<std::uint16_t>(beams_of(fire.fire));
  ping.bearings_cdeg = bearings_cdeg(ping.beams, mode.horizontal_deg / 2.0);
  ping.image_offset = usual_image_offset(fire.extension.has_value(), ping.beams);
  plan.listening = seconds(2.0 * plan.range_m / ping.sound_speed_mps);
  plan.period = std::max({period_of_rate(fire.fire.ping_rate).value_or(nanoseconds{0}),
                          plan.listening + config.ping_overhead, time_on_link(plan)});
  return plan;
}

double pressure_bar(std::optional<double> depth_m, const PlanConfig& config) {
  return depth_m ? config.surface_pressure_bar + bar_per_m * std::max(*depth_m, 0.0) : config.pressure_bar;
}

void report_readings(const SensorReadings& readings, const PlanConfig& config, PingResult& ping) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  const double heading_deg = config.heading_sign * readings.heading_rad * degrees;
  ping.heading_deg = heading_deg < 0.0 ? std::fmod(heading_deg + 360.0, 360.0) : heading_deg;
  ping.pitch_deg = config.pitch_sign * readings.pitch_rad * degrees;
  ping.roll_deg = config.roll_sign * readings.roll_rad * degrees;
  ping.pressure_bar = pressure_bar(readings.depth_m, config);
}

PingJob job_of(const PingPlan& plan, const PlanConfig& config) {
  const Fire& fire = plan.asked.fire;
  const PingResult& ping = plan.result;
  const double true_speed_mps =
      config.water_sound_speed_mps > 0.0 ? config.water_sound_speed_mps : ping.sound_speed_mps;
  PingJob job;
  job.listening_time = plan.listening;
  job.period = plan.period;
  job.native_bins = ping.ranges;
  job.native_bin_m = ping.range_resolution_m * true_speed_mps / ping.sound_speed_mps;
  job.sixteen_bit = ping.data_size != DataSize::bits_8;
  job.mode = static_cast<int>(config.model.mode_index(fire.master_mode));
  job.beams = ping.beams;
  job.amplitude_exponent = gamma_exponent(fire.gamma);
  job.sound_speed_mps = true_speed_mps;
  job.assumed_sound_speed_mps = ping.sound_speed_mps;
  job.gain_percent = std::isfinite(fire.gain_percent) ? std::clamp(fire.gain_percent, 0.0, 100.0) : 0.0;
  job.settings = {{"frequency", fmt::format("{:.0f}kHz", ping.frequency_hz * 1e-3)},
                  {"range", fmt::format("{:.2f}m", plan.range_m)},
                  {"beams", std::to_string(ping.beams)},
                  {"gain", fmt::format("{:.0f}%", job.gain_percent)},
                  {"gamma", std::to_string(fire.gamma)},
                  {"sound_speed", fmt::format("{:.1f}m/s", ping.sound_speed_mps)},
                  {"bits", std::to_string(8 * bytes_per_sample(ping.data_size))}};
  return job;
}

std::optional<std::vector<std::uint8_t>> image_bytes(const PingResult& ping,
                                                     const std::vector<std::uint8_t>& u8,
                                                     const std::vector<std::uint16_t>& u16) {
  const std::size_t count = std::size_t{ping.ranges} * ping.beams;
  const bool narrow = u16.empty();
  if ((narrow ? u8.size() : u16.size()) != count || (ping.data_size == DataSize::bits_8 && !narrow)) {
    return std::nullopt;
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(ping.ranges * row_size(ping));
  ByteWriter writer(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    if (i % ping.beams == 0 && (ping.fire.fire.flags & fire_flags::row_gains) != 0) {
      writer.u32le(row_gain);
    }
    // Full scale maps to full scale in every width.
    if (ping.data_size == DataSize::bits_8) {
      writer.u8(u8[i]);
    } else if (ping.data_size == DataSize::bits_16) {
      writer.u16le(narrow ? static_cast<std::uint16_t>(u8[i] * 0x101U) : u16[i]);
    } else {
      writer.u32le(narrow ? u8[i] * 0x1010101U : u16[i] * 0x10001U);
    }
  }
  return bytes;
}

}  // namespace sonard::oculus
