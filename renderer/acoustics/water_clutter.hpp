// SPDX-License-Identifier: Apache-2.0
// Single things that drift in the water: fish, weed, bubbles (docs/physics.md 2.16).
#pragma once

#include <cstdint>

#include "renderer/ping.hpp"
#include "renderer/pose.hpp"

namespace sonard::render {

/// Adds what the clutter of open water sends back, before spreading and absorption. It lies at places of the
/// world that `seed` draws, WaterClutter::density_per_m3 of it, out to 20 m, and is seen in a beam as far as
/// nothing else has sent an echo; target strengths are drawn around the mean, exponentially in intensity.
void add_water_clutter(const SonarSettings& settings, const Pose& T_world_sonar, std::uint64_t seed,
                       EchoImage& image);

}  // namespace sonard::render
