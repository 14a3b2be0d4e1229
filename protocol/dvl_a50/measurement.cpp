// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/measurement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "protocol/dvl_a50/beams.hpp"

namespace sonard::dvl_a50 {
namespace {

constexpr int grid_size = 16;
constexpr double nearest_m = 0.04;
constexpr double range_margin = 1.5;          ///< of a mode's longest beam, so that the next mode can follow
constexpr double longest_range_margin = 1.1;  ///< of the last mode
constexpr RangeMode water_layer{1.5, 4.5, 0.0};
constexpr double hot_c = 55.0;
constexpr double least_distance_m = 0.05;  ///< of rssi

/// Distances and validity of the beams, as the device reports them.
void place(const std::array<double, 4>& ranges_m, double scale, const DeviceConfig& config,
           const Settings& settings, std::array<Beam, 4>& beams) {
  const double step_m = settings.speed_of_sound_mps / config.distance_steps_hz;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    Beam& beam = beams[i];
    beam.id = static_cast<int>(i);
    beam.valid = ranges_m[i] > 0.0;
    beam.distance_m = beam.valid ? step_m * std::round(ranges_m[i] * scale / step_m) : -1.0;
    const double apart_m =
        std::max(beam.valid ? beam.distance_m : config.range_modes[4].most_m, least_distance_m);
    beam.rssi_dbm = config.rssi_at_half_metre_dbm - 20.0 * std::log10(apart_m / 0.5);
    beam.nsd_dbm = config.nsd_dbm;
  }
}

void make_invalid(Velocity& report, const DeviceConfig& config) {
  report.valid = false;
  report.velocity_mps = {};
  report.altitude_m = -1.0;
  report.fom_mps = config.invalid_fom_mps;
  report.covariance = {};
  for (std::size_t i = 0; i < 3; ++i) {
    report.covariance[i][i] = config.invalid_fom_mps * config.invalid_fom_mps;
  }
}

/// In water tracking a beam sees the middle of its layer, unless something is in front of it.
std::array<double, 4> water_ranges_m(const std::array<double, 4>& ranges_m) {
  std::array<double, 4> seen{};
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const bool blocked = ranges_m[i] > 0.0 && ranges_m[i] * beam_cosine < water_layer.least_m;
    seen[i] = blocked ? 0.0 : (water_layer.least_m + water_layer.most_m) / 2.0 / beam_cosine;
  }
  return seen;
}

}  // namespace

Directions beam_grid() {
  return {.columns = grid_size,
          .rows = grid_size,
          .horizontal_fov_rad = 2.0 * std::atan2(beam_lateral, beam_cosine),
          .vertical_fov_rad = 2.0 * std::asin(beam_lateral),
          .nearest_m = nearest_m};
}

// Up of the grid is forward, port is port: the lowest row has the beams 1 and 0, the highest 2 and 3.
std::optional<std::array<double, 4>> beam_ranges_m(const DirectionRanges& ranges) {
  constexpr std::size_t last = grid_size - 1, top = last * grid_size;
  if (ranges.columns != grid_size || ranges.rows != grid_size ||
      ranges.range_m.size() != beam_grid().count()) {
    return std::nullopt;
  }
  const auto at = [&](std::size_t place) { return static_cast<double>(ranges.range_m[place]); };
  return std::array<double, 4>{at(last), at(0), at(top), at(top + last)};
}

PingPlan plan_ping(std::optional<int> mode, const DeviceConfig& config, const Settings& settings) {
  PingPlan plan{mode, parse_range_mode(settings.range_mode).value_or(RangeChoice{})};
  if (plan.choice.water) {
    plan.range_m = water_layer.most_m / beam_cosine;
    return plan;
  }
  if (mode && (*mode < plan.choice.first || *mode > plan.choice.last)) {
    plan.mode.reset();
  }
  const int widest = plan.mode.value_or(plan.choice.last);
  const double margin = widest == 4 ? longest_range_margin : range_margin;
  plan.range_m = margin * config.range_modes[static_cast<std::size_t>(widest)].most_m / beam_cosine;
  return plan;
}

std::chrono::nanoseconds ping_period(const PingPlan& plan, const DeviceConfig& config) {
  const double rate_hz = plan.choice.water ? config.water_rate_hz
                         : plan.mode       ? config.range_modes[static_cast<std::size_t>(*plan.mode)].rate_hz
                                           : 1e9 / static_cast<double>(config.search_interval.count());
  return std::chrono::nanoseconds{std::llround(1e9 * config.time_scale / rate_hz)};
}

PingJob make_job(const PingPlan& plan, const DeviceConfig& config) {
  PingJob job;
  job.directions = beam_grid();
  job.native_bin_m = config.water_sound_speed_mps / config.distance_steps_hz;
  job.native_bins = static_cast<int>(std::ceil(plan.range_m / job.native_bin_m));
  job.sound_speed_mps = config.water_sound_speed_mps;
  job.listening_time =
      std::chrono::nanoseconds{std::llround(2e9 * plan.range_m / config.water_sound_speed_mps)};
  job.settings = {{"range", fmt::format("{:.2f}m", plan.range_m)},
                  {"mode", plan.mode           ? fmt::format("{}", *plan.mode)
                           : plan.choice.water ? "wt"
                                               : "search"}};
  return job;
}

Measurement measure(const std::array<double, 4>& ranges_m, const Motion& device, const PingPlan& plan,
                    const DeviceConfig& config, const Settings& settings, Noise& noise) {
  const bool water = plan.choice.water;
  // The device takes both for those in water of its own sound speed.
  const double scale = settings.speed_of_sound_mps / config.water_sound_speed_mps;
  Measurement result;
  Velocity& report = result.report;
  report.of_water = water;
  report.status = config.temperature_c >= hot_c ? 1 : 0;
  place(water ? water_ranges_m(ranges_m) : ranges_m, scale, config, settings, report.beams);

  Vector velocity_mps = device.velocity_mps;
  if (water) {
    const Vector current_mps = from_world(device.axes, config.water_current_mps);
    for (std::size_t i = 0; i < 3; ++i) {
      velocity_mps[i] -= current_mps[i];
    }
  }
  const double speed_mps = std::sqrt(dot(velocity_mps, velocity_mps));
  const double noise_mps = config.beam_noise_mps + config.beam_noise_factor * speed_mps;
  const bool too_fast = speed_mps > (water ? config.most_water_speed_mps : config.most_speed_mps);
  for (std::size_t i = 0; i < report.beams.size(); ++i) {
    Beam& beam = report.beams[i];
    const double error_mps = noise_mps * noise.next();
    beam.valid = beam.valid && !too_fast;
    beam.velocity_mps = beam.valid ? scale * dot(beam_directions[i], velocity_mps) + error_mps : 0.0;
  }
  const std::optional<double> altitude = altitude_m(report.beams, config.altitude_offset_m);
  if (altitude && !water) {
    result.mode = next_mode(plan.mode, *altitude, plan.choice, config.range_modes);
  }
  const std::optional<Solution> solution = solve(report.beams, noise_mps);
  if (!solution || !(water || result.mode)) {
    make_invalid(report, config);
    result.mode.reset();
    return result;
  }
  const double turn_rad = settings.mounting_rotation_offset_deg * std::numbers::pi / 180.0;
  report.valid = true;
  report.velocity_mps = to_vehicle(solution->velocity_mps, turn_rad);
  report.covariance = to_vehicle(solution->covariance, turn_rad);
  report.fom_mps = figure_of_merit(report.covariance);
  report.altitude_m = water ? -1.0 : *altitude;
  return result;
}

}  // namespace sonard::dvl_a50
