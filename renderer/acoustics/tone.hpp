// SPDX-License-Identifier: Apache-2.0
// A tone along the range, as the band of the transducer lets it through (docs/physics.md 2.6).
#pragma once

namespace sonard::render {

/// Length over which a tone spreads energy, in metres: the integral over its intensity, whose peak is 1. It
/// is c tau / 2, but no tone is shorter than the band of the transducer lets it be.
/// @param cell_m PhysicalModel::range_cell_m, > 0. @param rounding_m PhysicalModel::tone_rounding_m
double tone_length_m(double cell_m, double rounding_m);

/// A box whose ends are rounded: convolved with the main lobe of a sinc, which is what an even band makes of
/// an instant. The box is as long as tone_length_m() asks for.
class RoundedTone {
 public:
  /// @param cell_m, rounding_m as of tone_length_m(); rounding_m > 0
  RoundedTone(double cell_m, double rounding_m);

  /// Amplitude `at_m` from the middle, re that of the middle.
  double amplitude(double at_m) const { return overlap(at_m) / overlap(0); }
  /// Beyond it the amplitude is 0.
  double reach_m() const { return box_m_ / 2 + rounding_m_; }

 private:
  /// Of the box and the lobe, of any scale.
  double overlap(double at_m) const;
  /// Integral over the intensity re the peak.
  double length_m() const;

  double box_m_;
  double rounding_m_;
};

}  // namespace sonard::render
