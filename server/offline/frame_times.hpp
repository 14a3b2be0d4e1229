// SPDX-License-Identifier: Apache-2.0
// Ping times of a head along a trajectory.
#pragma once

#include "server/devices/survey.hpp"
#include "server/offline/options.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// Times at the requested rate, or else at the head's highest rate. With one frame for each pose
/// (OfflineOptions), all pings of a frame are at the stamp of its pose.
/// @param survey gives the number of pings of each frame
/// @throws Error
PingTimes frame_times(const VehicleTrajectory& trajectory, const OfflineOptions& options, Survey& survey);

}  // namespace sonard::server
