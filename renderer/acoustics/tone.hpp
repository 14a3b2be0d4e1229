// SPDX-License-Identifier: Apache-2.0
// A tone in range behind the band of the transducer (docs/physics.md 2.6).
#pragma once

namespace sonard::render {

/// Length over which a tone spreads energy, in metres: the integral of its intensity, whose peak is 1. It is
/// c tau / 2, but at least the length that the transducer's band allows.
/// @param cell_m PulseSettings::range_cell_m, > 0. @param rounding_m PulseSettings::tone_rounding_m
double tone_length_m(double cell_m, double rounding_m);

/// A box with rounded ends: convolved with the main lobe of a sinc, the response of an even band to an
/// impulse. The length of the box is chosen so that the result has tone_length_m().
class RoundedTone {
 public:
  /// @param cell_m, rounding_m as of tone_length_m(); rounding_m > 0
  RoundedTone(double cell_m, double rounding_m);

  /// Amplitude at a distance of `at_m` from the middle, re the middle.
  double amplitude(double at_m) const { return overlap(at_m) / overlap(0); }
  /// Beyond it the amplitude is 0.
  double reach_m() const { return box_m_ / 2 + rounding_m_; }

 private:
  /// Overlap of the box and the lobe, not normalised.
  double overlap(double at_m) const;
  /// Integral of the intensity re the peak.
  double length_m() const;

  double box_m_;
  double rounding_m_;
};

}  // namespace sonard::render
