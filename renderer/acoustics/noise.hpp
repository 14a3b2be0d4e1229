// Additive noise: what the array hears of itself and of others (docs/physics.md 2.9, 2.16).
#pragma once

#include <vector>

#include "renderer/acoustics/random.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Noise amplitude per beam: 1, raised in a stripe two acoustic beams wide in the middle of the fan
/// (docs/physics.md 2.16).
std::vector<float> noise_profile(const SonarSettings& settings);

/// What interference does to the noise of one ping.
struct InterferenceStreak {
  int first_line = 0;   ///< native; all lines from here on are raised
  float factor = 1.0F;  ///< of amplitude; 1: this ping is not hit

  float factor_at(int line) const { return raises(line) ? factor : 1.0F; }
  bool raises(int line) const { return factor != 1.0F && line >= first_line; }
};

/// Draws whether a ping is hit, from where, and by how much: evenly among all lines and all dB.
InterferenceStreak draw_interference(const Interference& interference, int lines, RandomKey key);

}  // namespace sonard::render
