// SPDX-License-Identifier: Apache-2.0
// The receive array: a straight line of elements half a wavelength apart.
#pragma once

#include <complex>
#include <vector>

#include "renderer/acoustics/random.hpp"
#include "renderer/aperture.hpp"

namespace sonard::render {

/// Weights of the elements from one end to the other, not yet normalised; symmetric, 1 at most
/// (docs/physics.md 2.5). @param elements at least 2
std::vector<double> taper_weights(Aperture::Taper taper, int elements);

/// Number of elements that an array with the aperture's taper needs for its beamwidth at broadside, within
/// 4 %; at least 2.
int element_count(const Aperture& aperture);

/// Weights of all elements with their errors, divided by their sum without errors: a faultless array receives
/// a source on its axis with amplitude 1.
class LineArray {
 public:
  /// An array without errors.
  explicit LineArray(const Aperture& aperture);
  /// An array with the errors that the aperture specifies, drawn with `key`.
  LineArray(const Aperture& aperture, RandomKey key);

  int elements() const { return static_cast<int>(weights_.size()); }
  /// Response to a source. @param sine_offset sine of its bearing minus sine of the beam's bearing
  std::complex<double> amplitude(double sine_offset) const;
  /// The response as power.
  double power(double sine_offset) const { return std::norm(amplitude(sine_offset)); }
  /// Mean power of the errors, over many such arrays, in any direction, re the axis of a faultless array
  /// (docs/physics.md 2.5); 0 without errors.
  double mean_error_power() const { return mean_error_power_; }

 private:
  std::vector<std::complex<double>> weights_;
  double mean_error_power_ = 0.0;
};

}  // namespace sonard::render
