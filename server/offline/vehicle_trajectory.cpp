// SPDX-License-Identifier: Apache-2.0
#include "server/offline/vehicle_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "server/error/error.hpp"
#include "server/pose/to_render.hpp"

namespace sonard::server {
namespace {

constexpr std::int64_t unix_ns_of_1980 = 315'532'800'000'000'000;

}  // namespace

std::int64_t PingTimes::at(std::int64_t ping) const {
  if (!stamps_ns.empty()) {
    return stamps_ns.at(static_cast<std::size_t>(ping));
  }
  return start_ns + std::llround(static_cast<double>(ping) * period_ns);
}

int PingTimes::count_until(std::int64_t end_ns) const {
  if (!stamps_ns.empty()) {
    return static_cast<int>(stamps_ns.size());
  }
  const double periods = static_cast<double>(end_ns - start_ns) / period_ns;
  if (!(periods < most_pings)) {
    throw Error(ErrorKind::usage,
                fmt::format("{:.0f} pings are too many (expected {} at most)", periods, most_pings));
  }
  auto last = static_cast<int>(periods);
  // The quotient may be one off if a ping is exactly at the end.
  while (at(last + 1) <= end_ns) {
    ++last;
  }
  while (last > 0 && at(last) > end_ns) {
    --last;
  }
  return last + 1;
}

render::Pose VehicleTrajectory::T_world_vehicle(std::int64_t time_ns) const {
  return to_render(trajectory_.at(time_ns).T_world_vehicle);
}

render::Pose VehicleTrajectory::T_world_vehicle_at_end(std::int64_t sent_ns, std::int64_t end_ns) const {
  return T_world_vehicle(rests(sent_ns, end_ns) ? sent_ns : end_ns);
}

bool VehicleTrajectory::rests(std::int64_t sent_ns, std::int64_t end_ns) const {
  const std::vector<pose::TrajectoryPoint>& points = trajectory_.points();
  const auto next = std::ranges::upper_bound(points, sent_ns, {}, &pose::TrajectoryPoint::time_ns);
  auto step = static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - points.begin() - 1, 0));
  for (; step < rest_steps_.size() && points[step].time_ns < end_ns; ++step) {
    if (rest_steps_[step]) {
      return true;
    }
  }
  return always_rests_;
}

render::Pose VehicleTrajectory::BodyWay::T_world_body(std::int64_t time_ns) const {
  return to_render(trajectory.at(time_ns).T_world_vehicle);
}

std::int64_t VehicleTrajectory::unix_ns(std::int64_t time_ns) const {
  return start_ns() >= unix_ns_of_1980 ? time_ns : unix_ns_of_1980 + time_ns;
}

}  // namespace sonard::server
