// SPDX-License-Identifier: Apache-2.0
// From the echoes of a ping to its report (4).
#pragma once

#include <array>
#include <optional>

#include "protocol/common/ping_job.hpp"
#include "protocol/dvl_a50/device_config.hpp"
#include "protocol/dvl_a50/motion.hpp"
#include "protocol/dvl_a50/noise.hpp"

namespace sonard::dvl_a50 {

/// A regular grid whose corners are the beams, fine enough for the width of a beam.
Directions beam_grid();
/// By the id of the beam; 0: no echo. nullopt: the ranges are not those of beam_grid().
std::optional<std::array<double, 4>> beam_ranges_m(const DirectionRanges& ranges);

/// The range mode of a ping, and the range up to which it listens.
struct PingPlan {
  std::optional<int> mode;  ///< nullopt: a search
  RangeChoice choice;
  double range_m = 0.0;
};
/// `mode` is that of the last measurement.
PingPlan plan_ping(std::optional<int> mode, const DeviceConfig& config, const Settings& settings);
/// From this ping to the next.
std::chrono::nanoseconds ping_period(const PingPlan& plan, const DeviceConfig& config);

/// The job of a ping that is not recorded, without its period.
PingJob make_job(const PingPlan& plan, const DeviceConfig& config);

struct Measurement {
  Velocity report;          ///< without times
  std::optional<int> mode;  ///< for the next ping; nullopt: no bottom lock
};
/// `ranges_m` are the true slant ranges, 0 without an echo; `device` is the motion in the frame of the
/// device.
Measurement measure(const std::array<double, 4>& ranges_m, const Motion& device, const PingPlan& plan,
                    const DeviceConfig& config, const Settings& settings, Noise& noise);

}  // namespace sonard::dvl_a50
