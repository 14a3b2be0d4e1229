// The level of additive noise from the sonar equation (docs/physics.md 2.9).
#pragma once

namespace sonard::render {

/// What the level of noise follows from. Levels in dB re 1 uPa.
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

}  // namespace sonard::render
