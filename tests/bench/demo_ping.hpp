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
/// Adds `ping_ms` with its quantiles, and `visibility_ms`, `binning_ms`, `multipath_ms`, `reception_ms`
/// (array and pulse) and `receiver_ms`. Reads meshes in child processes: call it before threads exist.
/// @throws the exceptions of loading a configuration or a world
void measure_demo_ping(Measurements& results, const Repetition& repetition);

}  // namespace sonard::bench
