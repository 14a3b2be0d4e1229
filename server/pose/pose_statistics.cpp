// SPDX-License-Identifier: Apache-2.0
#include "server/pose/pose_statistics.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "server/pose/pose_history.hpp"
#include "server/pose/pose_track.hpp"

namespace sonard::server {
namespace {

double seconds(std::chrono::nanoseconds time) {
  return 1e-9 * static_cast<double>(time.count());
}

bool jumped(const pose::PoseSample& from, const pose::PoseSample& to) {
  const pose::Vec3& a = from.T_world_vehicle.position_m;
  const pose::Vec3& b = to.T_world_vehicle.position_m;
  const double distance_m = std::hypot(b.x - a.x, b.y - a.y, b.z - a.z);
  return distance_m >
         PoseTrack::teleport_mps * 1e-9 * static_cast<double>(std::abs(to.time_ns - from.time_ns));
}

std::string milliseconds(std::chrono::nanoseconds time) {
  return fmt::format("{:.0f}", 1e3 * seconds(time));
}

constexpr std::uint64_t enough_slow_steps = 3;  // fewer may be a pause, or a busy machine

}  // namespace

void PoseStatistics::SlowSteps::note(std::chrono::nanoseconds step) {
  const bool slow = step > slow_step;
  count = slow ? count + 1 : 0;
  sum = slow ? sum + step : std::chrono::nanoseconds{0};
}

std::optional<double> PoseStatistics::slow_rate_hz(bool by_stamps, TimePoint now) const {
  const SlowSteps& steps = by_stamps ? slow_stamps_ : slow_arrivals_;
  if (steps.count < enough_slow_steps) {
    return std::nullopt;
  }
  const double mean_s = seconds(steps.sum) / static_cast<double>(steps.count);
  const bool stopped = !by_stamps && seconds(now - newest_arrival_) > 3.0 * mean_s;
  return stopped ? std::nullopt : std::optional{1.0 / mean_s};
}

void PoseStatistics::observe(const pose::PoseSample& sample, TimePoint arrival) {
  for (Period* period : {&recent_, &all_}) {
    if (!period->begin) {
      period->begin = arrival;
    }
    ++period->poses;
    if (newest_) {
      observe_step(*period, sample, arrival);
    }
  }
  if (newest_) {
    slow_arrivals_.note(arrival - newest_arrival_);
    slow_stamps_.note(std::chrono::nanoseconds{sample.time_ns - newest_->time_ns});
  }
  stamps_.observe(sample, arrival);
  newest_ = sample;
  newest_arrival_ = arrival;
}

void PoseStatistics::observe_step(Period& period, const pose::PoseSample& sample, TimePoint arrival) const {
  const std::chrono::nanoseconds gap = arrival - newest_arrival_;
  period.longest_gap = std::max(period.longest_gap, gap);
  period.gaps += gap > gap_limit_ ? 1 : 0;
  const std::int64_t step_ns = sample.time_ns - newest_->time_ns;
  if (step_ns < -PoseHistory::reset_threshold.count()) {
    ++period.clock_restarts;
    period.last_restart = arrival;
    return;
  }
  period.jumps += jumped(*newest_, sample) ? 1 : 0;
  period.stamps_ns += step_ns;
  period.arrivals += gap;
}

PoseStatistics::Summary PoseStatistics::take(TimePoint now) {
  const Summary result = summary(recent_, now);
  const bool began = recent_.begin.has_value();
  recent_ = {};
  if (began) {
    recent_.begin = now;
  }
  return result;
}

PoseStatistics::Summary PoseStatistics::summary(const Period& period, TimePoint now) const {
  Summary result;
  result.poses = period.poses;
  result.longest_gap = period.longest_gap;
  result.gaps = period.gaps;
  result.jumps = period.jumps;
  result.clock_restarts = period.clock_restarts;
  if (period.last_restart) {
    result.since_restart = now - *period.last_restart;
  }
  if (period.begin && now > *period.begin) {
    result.rate_hz = static_cast<double>(period.poses) / seconds(now - *period.begin);
  }
  if (period.arrivals.count() > 0) {
    result.time_rate = 1e-9 * static_cast<double>(period.stamps_ns) / seconds(period.arrivals);
  }
  if (newest_) {
    const std::chrono::nanoseconds age = now - newest_arrival_;
    result.age = age;
    result.longest_gap = std::max(result.longest_gap, age);
    result.gaps += age > gap_limit_ ? 1 : 0;
  }
  return result;
}

std::string to_string(const PoseStatistics::Summary& summary) {
  return fmt::format(
      "poses={} rate_hz={:.1f} time_rate={} age_ms={} longest_gap_ms={} gaps={} jumps={} clock_restarts={}",
      summary.poses, summary.rate_hz, summary.time_rate ? fmt::format("{:.2f}", *summary.time_rate) : "-",
      summary.age ? milliseconds(*summary.age) : "-", milliseconds(summary.longest_gap), summary.gaps,
      summary.jumps, summary.clock_restarts);
}

}  // namespace sonard::server
