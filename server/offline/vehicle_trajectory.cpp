// SPDX-License-Identifier: Apache-2.0
#include "server/offline/vehicle_trajectory.hpp"

#include <cmath>

#include <fmt/format.h>

#include "server/pose/to_render.hpp"

namespace sonard::server {
namespace {

constexpr int most_pings = 10'000'000;
constexpr std::int64_t unix_ns_of_1980 = 315'532'800'000'000'000;

}  // namespace

std::int64_t PingTimes::at(std::int64_t ping) const {
  return start_ns + std::llround(static_cast<double>(ping) * period_ns);
}

int PingTimes::count_until(std::int64_t end_ns) const {
  const double periods = static_cast<double>(end_ns - start_ns) / period_ns;
  if (!(periods < most_pings)) {
    throw TooManyPings(fmt::format("{:.0f} pings are too many (expected {} at most)", periods, most_pings));
  }
  auto last = static_cast<int>(periods);
  // The quotient may be one off where a ping falls on the end.
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

render::Pose VehicleTrajectory::BodyWay::T_world_body(std::int64_t time_ns) const {
  return to_render(trajectory.at(time_ns).T_world_vehicle);
}

std::int64_t VehicleTrajectory::unix_ns(std::int64_t time_ns) const {
  return start_ns() >= unix_ns_of_1980 ? time_ns : unix_ns_of_1980 + time_ns;
}

}  // namespace sonard::server
