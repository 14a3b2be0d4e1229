// SPDX-License-Identifier: Apache-2.0
// The measurements of the two modes of the benchmark.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/campaign.hpp"

namespace sonard::bench {

/// Measures the main scenes with the presets, in a minute or two (docs/benchmark.md).
void run_quick(Campaign& campaign);

/// Measures all scenes, the ladders of sampling, and the growth of time with triangles, beams, bins and
/// cores. Takes a quarter of an hour on two cores.
/// @param only selects scenes whose names start with one of these; empty: all
void run_sweep(Campaign& campaign, const std::vector<std::string>& only);

}  // namespace sonard::bench
