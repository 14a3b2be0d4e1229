// SPDX-License-Identifier: Apache-2.0
// Splits a recorded scan into turns or sweeps.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/picture/sweep_image.hpp"
#include "server/logs/log_reader.hpp"

namespace sonard::server {

/// A full turn, or in a sector one sweep from limit to limit; the first and the last may be shorter.
struct RecordedSweep {
  picture::SweepShape shape;  ///< bearings relative to the vehicle, whatever side the head is mounted on
  std::size_t begin = 0;      ///< lines [begin, end) of LoggedHead::pings
  std::size_t end = 0;
};

/// Bearing as in pictures: 1/16 gradian, 3200 ahead, increasing to starboard.
int picture_bearing(const LoggedPing& line);

/// Uses only bearings and bins. A sweep ends when the head has come round or turns back, or when the length
/// or number of bins changes. If the head stands still, it ends after as many lines as there are bearings.
/// Every line is in one sweep.
std::vector<RecordedSweep> sweeps_of(const LoggedHead& head);

}  // namespace sonard::server
