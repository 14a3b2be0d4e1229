// SPDX-License-Identifier: Apache-2.0
// Single drifting objects in the water: fish, weed, bubbles (docs/physics.md 2.16).
#pragma once

#include <cstdint>

#include "renderer/ping.hpp"
#include "renderer/pose.hpp"

namespace sonard::render {

/// Adds the echoes of clutter in open water, before spreading and absorption. Clutter has places in the world
/// that are drawn with `seed`, WaterClutter::density_per_m3 of them, out to 20 m. A beam receives only
/// clutter nearer than its first other echo. The intensity of targets is exponentially distributed.
void add_water_clutter(const SonarSettings& settings, const Pose& T_world_sonar, std::uint64_t seed,
                       EchoImage& image);

}  // namespace sonard::render
