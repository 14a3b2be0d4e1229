// SPDX-License-Identifier: Apache-2.0
// What the water itself scatters back: bubbles, plankton, silt (docs/physics.md 2.10).
#pragma once

#include <vector>

#include "renderer/ping.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// True: mode `physical`, and the water scatters at all.
bool has_volume_reverberation(const SonarSettings& settings);

/// Adds to every line what scatters in it, before spreading and absorption: the scattering coefficient times
/// what of the beam is still open times the length of the line.
/// @param open_sr BinningResult::open_sr.
void add_volume_reverberation(const std::vector<float>& open_sr, const SonarSettings& settings,
                              EchoImage& image);

}  // namespace sonard::render
