// SPDX-License-Identifier: Apache-2.0
// When a head pings along a trajectory.
#pragma once

#include "server/devices/survey.hpp"
#include "server/offline/options.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// At the rate asked for, else as fast as the head can. Of one frame for each pose (OfflineOptions) all pings
/// of a frame are at the stamp of its pose.
/// @param survey lays pings out to find out how many a frame has
/// @throws TooManyPings
PingTimes frame_times(const VehicleTrajectory& trajectory, const OfflineOptions& options, Survey& survey);

}  // namespace sonard::server
