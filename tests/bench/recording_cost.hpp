// SPDX-License-Identifier: Apache-2.0
// Measures the cost of recording a ping, on the serving thread and on the recorder's thread.
#pragma once

#include <string>

#include "tests/bench/measurements.hpp"

namespace sonard::bench {

/// Records pings of 256 x 1000 bins with noise, in each format alone and in all together, in a temporary
/// folder. Scene `recording`, presets `glf`, `mcap`, `pcapng` and `all_formats` (docs/benchmark.md).
void measure_recording(Measurements& results);

/// A summary in one line.
std::string describe_recording(const Measurements& results);

}  // namespace sonard::bench
