// SPDX-License-Identifier: Apache-2.0
// Where one turn of a recorded scan ends and the next begins.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/picture/sweep_image.hpp"
#include "server/logs/recording.hpp"

namespace sonard::server {

/// Once round, or in a sector once from one limit to the other; the first and the last may be less.
struct RecordedSweep {
  picture::SweepShape shape;  ///< bearings are those of the vehicle, whatever side the head is mounted on
  std::size_t begin = 0;      ///< lines [begin, end) of LoggedHead::pings
  std::size_t end = 0;
};

/// 1/16 gradian, 3200 ahead, rising to starboard, as pictures have it.
int picture_bearing(const LoggedPing& line);

/// By the bearings alone: a turn ends where the head has come round or turns back, with another length or
/// number of bins, and after as many lines as there are bearings where it stands still. Every line is in one.
std::vector<RecordedSweep> sweeps_of(const LoggedHead& head);

}  // namespace sonard::server
