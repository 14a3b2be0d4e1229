// SPDX-License-Identifier: Apache-2.0
// The end of the receiver: range compression and the quantiser.
#pragma once

#include "renderer/aligned_vector.hpp"
#include "renderer/ping.hpp"

namespace sonard::render {

/// Buffers of the size and sample type given by `settings`, all zero.
PingSamples make_samples(const SonarSettings& settings);

/// Amplitude 1 in codes of the output, or 1 if codes are decibels, divided by the number of
/// range bins of a mean. Multiply amplitudes by it before Quantizer::add().
float codes_per_amplitude(const SonarSettings& settings);

/// Joins range bins to output lines: amplitudes to their mean or peak, decibels to their mean, because a
/// receiver of decibels averages behind its logarithm. One per thread; all write to the same samples.
class Quantizer {
 public:
  Quantizer(const SonarSettings& settings, PingSamples& samples);

  void begin();
  /// @param codes amplitude of one range bin per beam, times codes_per_amplitude(). A range bin that is 0 in
  /// all beams may be left out.
  /// @param weight in the mean of decibels, > 0; ignored for amplitudes
  void add(const float* codes, float weight = 1.0F);
  /// Quantises the line: rounds as the output scale requires and clamps, so that no code wraps.
  void end(int output_line);

 private:
  PingSamples& samples_;
  OutputScale scale_;
  float exponent_;
  bool peak_;
  float terms_ = 0;  ///< sum of the weights that were added
  AlignedVector<float> sum_;
};

}  // namespace sonard::render
