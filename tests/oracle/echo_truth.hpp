// SPDX-License-Identifier: Apache-2.0
// The result of an integrator of the oracle: an image and its estimated error.
#pragma once

#include <cstdint>
#include <vector>

namespace sonard::oracle {

/// Echo per beam and range line, with an error estimate of each value.
struct EchoTruth {
  int beams = 0;
  int lines = 0;
  /// [beam * lines + line]. Mode `physical`: sum of s_b / cos(phi) dOmega r^-2 10^(-alpha r / 5) times the
  /// elevation pattern, steradians per square metre; mode `paper`: the mean, in [0, 1].
  std::vector<double> echo;
  std::vector<double> error;  ///< absolute, >= 0, one per value
  std::uint64_t rays = 0;     ///< number of rays or slices

  double at(int beam, int line) const { return echo[index(beam, line)]; }
  double error_at(int beam, int line) const { return error[index(beam, line)]; }

 private:
  std::size_t index(int beam, int line) const {
    return static_cast<std::size_t>(beam) * static_cast<std::size_t>(lines) + static_cast<std::size_t>(line);
  }
};

/// Relative error over the bins above a threshold (docs/physics.md 3.3).
struct RelativeError {
  double rms = 0.0;  ///< over all bins above 1e-2 of their beam's maximum
  double max = 0.0;  ///< largest over all bins above 1e-4 of their beam's maximum
};

/// `truth.error` relative to `truth.echo`.
RelativeError estimated_error(const EchoTruth& truth);

/// |a - b| relative to b. Both must have the same size.
RelativeError difference(const EchoTruth& a, const EchoTruth& b);

}  // namespace sonard::oracle
