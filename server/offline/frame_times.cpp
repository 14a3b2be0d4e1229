// SPDX-License-Identifier: Apache-2.0
#include "server/offline/frame_times.hpp"

#include <cstddef>
#include <vector>

#include <fmt/format.h>

namespace sonard::server {
namespace {

/// First pings of this number of frames, and the first ping after the last frame.
std::vector<int> first_pings_of(std::size_t frames, Survey& survey) {
  std::vector<int> first_pings;
  for (int pings = static_cast<int>(frames); first_pings.size() <= frames; pings *= 2) {
    if (pings > most_pings) {
      throw Error(ErrorKind::usage,
                  fmt::format("{} poses are too many (expected {} pings at most)", frames, most_pings));
    }
    first_pings = survey.frames(pings);
  }
  first_pings.resize(frames + 1);
  return first_pings;
}

}  // namespace

PingTimes frame_times(const VehicleTrajectory& trajectory, const OfflineOptions& options, Survey& survey) {
  PingTimes times{trajectory.start_ns(), options.rate_hz
                                             ? 1e9 / *options.rate_hz
                                             : static_cast<double>(survey.natural_period().count())};
  if (options.frame_for_each_pose()) {
    const std::vector<pose::TrajectoryPoint>& points = trajectory.points();
    const std::vector<int> first_pings = first_pings_of(points.size(), survey);
    for (std::size_t frame = 0; frame < points.size(); ++frame) {
      times.stamps_ns.resize(static_cast<std::size_t>(first_pings[frame + 1]), points[frame].time_ns);
    }
  }
  return times;
}

}  // namespace sonard::server
