// SPDX-License-Identifier: Apache-2.0
// The error of an echo image (docs/physics.md 3.3, docs/benchmark.md).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/ping.hpp"

namespace sonard::bench {

/// Errors of an image. Ratios are relative to the reference; "bins" are range lines.
struct ImageError {
  /// Root of the mean of (image / reference - 1)^2 over all bins whose reference is above 1e-2 of their
  /// beam's maximum, over all beams.
  double bin_rms = 0;
  /// bin_rms without the worst 1 % of those bins.
  double bin_rms_trim = 0;
  /// Distance of the first echoes in the worst beam. The first echo is the range at which the summed echo,
  /// spread evenly inside a bin, reaches 1e-2 of the largest bin of the reference's beam.
  double first_echo_bins = 0;
  /// Share of empty bins among the bins above 1e-2 (and above 1e-6) of their beam's maximum. A bin is empty
  /// if it is below a thousandth of its reference.
  double hole_fraction = 0;
  double hole_fraction_60db = 0;
  /// | sum of the beam / its reference - 1 |, over all beams with an echo.
  double beam_total_mean = 0;
  double beam_total_worst = 0;
  std::uint64_t bins = 0;  ///< number of bins in bin_rms
};

/// Compares images of the same size. nullopt if the reference has no echo.
/// @throws std::invalid_argument if the sizes differ
std::optional<ImageError> compare_images(const render::EchoImage& image, const render::EchoImage& reference);

/// The error of one beam.
struct BeamError {
  double total = 0;             ///< | sum of the beam / its reference - 1 |
  double centroid_lines = 0;    ///< distance of the centroids
  double first_echo_lines = 0;  ///< ImageError::first_echo_bins of this beam
};

/// The errors of all beams with an echo. Both images must have the same size.
std::vector<BeamError> compare_beams(const render::EchoImage& image, const render::EchoImage& reference);

}  // namespace sonard::bench
