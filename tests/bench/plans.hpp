// SPDX-License-Identifier: Apache-2.0
// What the benchmark measures: the plan of each of its two modes.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/campaign.hpp"

namespace sonard::bench {

/// What the targets need, in less than a minute (docs/benchmark.md).
void run_quick(Campaign& campaign);

/// Every scene, the ladders of sampling, and how time grows with triangles, beams, bins and cores. Only
/// scenes whose name starts with one of `only`, all when it is empty. Takes a quarter of an hour on two
/// cores.
void run_sweep(Campaign& campaign, const std::vector<std::string>& only);

}  // namespace sonard::bench
