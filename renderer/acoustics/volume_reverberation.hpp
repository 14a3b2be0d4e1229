// SPDX-License-Identifier: Apache-2.0
// Echo of the water itself: bubbles, plankton, silt (docs/physics.md 2.10).
#pragma once

#include <vector>

#include "renderer/ping.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// True in mode `physical` if the sonar transmits and the water scatters.
bool has_volume_reverberation(const SonarSettings& settings);

/// Adds the echo of the water to every line, before spreading and absorption: the scattering coefficient
/// times the open solid angle of the beam times the length of the line.
/// @param open_sr BinningResult::open_sr
void add_volume_reverberation(const std::vector<float>& open_sr, const SonarSettings& settings,
                              EchoImage& image);

}  // namespace sonard::render
