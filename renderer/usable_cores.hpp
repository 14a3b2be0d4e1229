// SPDX-License-Identifier: Apache-2.0
// Number of cores that this process may use; on a shared machine fewer than the machine has.
#pragma once

#include <string_view>

namespace sonard::render {

/// Cores on which the scheduler may run the calling thread (set by taskset and Slurm), at most the quota of
/// its container, rounded up. >= 1. Any thread may call it.
unsigned usable_cores();

/// @param cpu_max contents of the file of this name in a Linux control group, version 2: "150000 100000" is
/// one and a half cores, "max 100000" all.
/// @return the quota rounded up to whole cores, >= 1; 0 if there is no limit or the text is invalid
unsigned cores_of_quota(std::string_view cpu_max);

}  // namespace sonard::render
