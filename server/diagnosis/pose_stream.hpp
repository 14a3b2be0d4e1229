// SPDX-License-Identifier: Apache-2.0
// Findings about the poses of one input.
#pragma once

#include <cstddef>
#include <vector>

#include "server/diagnosis/finding.hpp"
#include "server/pose/pose_inputs.hpp"

namespace sonard::server {

/// Finds stamps in a wrong unit or without meaning, a clock that went back, and several publishers at once.
/// Belongs to the I/O thread.
/// @param index of the input
std::vector<Finding> look_at_stream(const PoseInputs& inputs, std::size_t index, TimePoint now);

}  // namespace sonard::server
