// SPDX-License-Identifier: Apache-2.0
// How many cores this process may use, which on a machine that is shared are fewer than it has.
#pragma once

#include <string_view>

namespace sonard::render {

/// Cores that the scheduler lets the calling thread run on (as taskset and Slurm set them), no more than the
/// quota of its container, rounded up. >= 1. For any thread.
unsigned usable_cores();

/// @param cpu_max the file of this name of a Linux control group, version 2: "150000 100000" is one and a
/// half cores, "max 100000" all.
/// @return whole cores that hold it, >= 1; 0 where there is no limit or the text is none
unsigned cores_of_quota(std::string_view cpu_max);

}  // namespace sonard::render
