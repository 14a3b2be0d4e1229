// SPDX-License-Identifier: Apache-2.0
// Findings about the poses of one input.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "server/diagnosis/finding.hpp"
#include "server/pose/pose_inputs.hpp"

namespace sonard::server {

/// Finds the most likely fault of the stamps of one stream: missing ones, a wrong unit, or a clock that went
/// back. One fault may have several signs, so there is at most one finding. It names the field and its unit.
std::optional<Finding> look_at_stamps(const PoseStatistics& statistics, const StampField& field,
                                      PingClock clock, TimePoint now);

/// Finds poses that arrive too rarely for an image that moves smoothly. Pings that follow the stamps of poses
/// need stamps that are close together, however late they arrive.
std::optional<Finding> look_at_rate(const PoseStatistics& statistics, PingClock clock, TimePoint now);

/// Code of the finding about messages that could not be read; their source has logged them.
inline constexpr const char* unreadable_code = "unreadable_messages";

/// Finds faults of the stamps, several publishers at once, and messages that give no pose. Belongs to the I/O
/// thread.
/// @param index of the input
std::vector<Finding> look_at_stream(const PoseInputs& inputs, std::size_t index, TimePoint now);

}  // namespace sonard::server
