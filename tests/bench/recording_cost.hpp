// SPDX-License-Identifier: Apache-2.0
// What recording takes of a ping, on the thread that serves and on the recorder's.
#pragma once

#include <string>

#include "tests/bench/measurements.hpp"

namespace sonard::bench {

/// Pings of 256 x 1000 bins, with noise, into files of each format alone and of all together, in a folder for
/// temporary files. Scene `recording`, presets `glf`, `mcap`, `pcapng` and `all_formats` (docs/benchmark.md).
void measure_recording(Measurements& results);

/// One line for people.
std::string describe_recording(const Measurements& results);

}  // namespace sonard::bench
