// SPDX-License-Identifier: Apache-2.0
// Additive noise: its level, and what the array receives of itself and of others (docs/physics.md 2.9, 2.16).
#pragma once

#include <vector>

#include "renderer/acoustics/random.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// The terms of the noise level. Levels in dB re 1 uPa.
struct NoiseBudget {
  double source_level_db = 200.0;  ///< at 1 m
  double spectral_level_db = 0.0;  ///< of 1 Hz, where the array is
  double directivity_db = 30.0;    ///< of the receive array
  double bandwidth_hz = 94'000.0;  ///< of the receiver: that of the pulse
};

/// Thermal noise of the sea, dB re 1 uPa^2/Hz (Mellen 1952): above some hundred kHz it drowns wind and waves.
double thermal_noise_db(double carrier_hz);

/// PhysicalModel::noise_level_db of the sonar equation: NL - DI + 10 log10 B - SL.
double noise_level_db(const NoiseBudget& budget);

/// Noise amplitude per beam: 1, raised in a stripe two acoustic beams wide in the middle of the fan
/// (docs/physics.md 2.16).
std::vector<float> noise_profile(const SonarSettings& settings);

/// Amplitude of noise at a bearing of a scanning head, re the mean over all in decibels: levels drawn evenly
/// within PhysicalModel::noise_by_bearing_db for every 9 degrees, and a straight line between them.
/// @param bearing_rad as ScanPose has it
float noise_at_bearing(const PhysicalModel& model, double bearing_rad, RandomKey key);

/// Interference in the noise of one ping.
struct InterferenceBurst {
  int first_line = 0;   ///< range bins from here on are raised
  int end_line = 0;     ///< up to this one, which is not
  float factor = 1.0F;  ///< of amplitude; 1: this ping is not hit

  float factor_at(int line) const { return raises(line) ? factor : 1.0F; }
  bool raises(int line) const { return factor != 1.0F && line >= first_line && line < end_line; }
};

/// Draws whether a ping is hit, from where, by how much and how far: evenly among all lines and all dB; its
/// length evenly in its logarithm between half and twice the median.
InterferenceBurst draw_interference(const Interference& interference, const RangeLines& range, RandomKey key);

}  // namespace sonard::render
