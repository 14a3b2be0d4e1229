// Additive noise: what the array hears of itself and of the sea (docs/physics.md 2.9).
#pragma once

#include <vector>

#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Noise amplitude per beam: 1, raised in a stripe two acoustic beams wide in the middle of the fan
/// (docs/physics.md 2.16).
std::vector<float> noise_profile(const SonarSettings& settings);

}  // namespace sonard::render
