// SPDX-License-Identifier: Apache-2.0
// The end of the receiver: range compression and the quantiser.
#pragma once

#include "renderer/aligned_vector.hpp"
#include "renderer/ping.hpp"

namespace sonard::render {

/// Buffers of the size and kind that `settings` ask for, all zero.
PingSamples make_samples(const SonarSettings& settings);

/// Amplitude 1 (full scale) in codes of the output, or 1 where codes are decibels, shared among the
/// range bins of a mean: amplitudes come to Quantizer multiplied with this.
float codes_per_amplitude(const SonarSettings& settings);

/// Joins range bins to output lines: amplitudes to their mean or peak, decibels to their mean, for a receiver
/// of decibels averages behind its logarithm. Each thread has one of its own; they share the samples.
class Quantizer {
 public:
  Quantizer(const SonarSettings& settings, PingSamples& samples);

  void begin();
  /// @param codes amplitude of one range bin in each beam, times codes_per_amplitude(). A line that is 0
  /// throughout may be left out.
  /// @param weight in the mean of decibels, > 0; amplitudes all weigh the same
  void add(const float* codes, float weight = 1.0F);
  /// Quantises last, rounding as the scale says, and clamping: nothing wraps.
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
