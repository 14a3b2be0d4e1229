// SPDX-License-Identifier: Apache-2.0
// Additive noise: its level, its profiles, and interference (docs/physics.md 2.9, 2.16).
#pragma once

#include <vector>

#include "renderer/acoustics/random.hpp"
#include "renderer/aperture.hpp"
#include "renderer/physical_model.hpp"
#include "renderer/range_bins.hpp"

namespace sonard::render {

/// The terms of the noise level. Levels in dB re 1 uPa.
struct NoiseBudget {
  double source_level_db = 200.0;  ///< at 1 m
  double spectral_level_db = 0.0;  ///< in 1 Hz, at the array
  double directivity_db = 30.0;    ///< of the receive array
  double bandwidth_hz = 94'000.0;  ///< of the receiver: the bandwidth of the pulse
};

/// Thermal noise of the sea, dB re 1 uPa^2/Hz (Mellen 1952). Above a few hundred kHz it exceeds the noise of
/// wind and waves.
double thermal_noise_db(double carrier_hz);

/// NoiseSettings::level_db of the sonar equation: NL - DI + 10 log10 B - SL.
double noise_level_db(const NoiseBudget& budget);

/// Noise amplitude per beam: 1, raised in a stripe two acoustic beams wide in the middle of the fan
/// (docs/physics.md 2.16).
std::vector<float> noise_profile(const NoiseSettings& noise, const Aperture& aperture);

/// Amplitude of noise at a bearing of a scanning head, re the mean level in dB over all bearings. Levels are
/// uniform within NoiseSettings::by_bearing_db, one every 9 degrees, with linear interpolation in dB.
/// @param bearing_rad ScanPose::bearing_rad
float noise_at_bearing(const NoiseSettings& noise, double bearing_rad, RandomKey key);

/// Interference in the noise of one ping.
struct InterferenceBurst {
  int first_line = 0;  ///< range bins [first_line, end_line) are raised
  int end_line = 0;
  float factor = 1.0F;  ///< of amplitude; 1: no interference in this ping

  float factor_at(int line) const { return raises(line) ? factor : 1.0F; }
  bool raises(int line) const { return factor != 1.0F && line >= first_line && line < end_line; }
};

/// Draws the interference of one ping. First line and raise in dB are uniform; the logarithm of the length is
/// uniform between half and twice the median.
InterferenceBurst draw_interference(const Interference& interference, const RangeBins& range, RandomKey key);

}  // namespace sonard::render
