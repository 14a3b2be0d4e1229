// SPDX-License-Identifier: Apache-2.0
// The ping that a newcomer sees first: the demo's, with all stages as the daemon serves it.
#pragma once

#include "tests/bench/measurements.hpp"
#include "tests/bench/timing.hpp"

namespace sonard::bench {

/// The subject of measure_demo_ping().
inline const Subject demo_ping{"demo", "cpu", "configured"};

/// Times whole pings of configs/demo.yaml along the trajectory of `sonard demo`, with the settings that the
/// head gives to the renderer: 20 m in 1205 range bins, all effects, moving between pings and within them.
/// Adds the medians `ping_ms`, `visibility_ms`, `binning_ms`, `multipath_ms`, `reception_ms` (array and
/// pulse) and `receiver_ms`, and their least values, `ping_ms_min` and so on.
///
/// Adds `differing_samples` for `fast` and `default`: the share of samples that differ by more than one code
/// from the samples with `reference` and the same seeds, over pings along the whole trajectory. Reads meshes
/// in child processes: call it before threads exist.
/// @param compared_pings number of these pings; 0: no comparison
/// @throws the exceptions of loading a configuration or a world
void measure_demo_ping(Measurements& results, const Repetition& repetition, int compared_pings);

}  // namespace sonard::bench
