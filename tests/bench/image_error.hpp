// SPDX-License-Identifier: Apache-2.0
// How far an echo image is from the truth (docs/physics.md 3.3, docs/benchmark.md).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/ping.hpp"

namespace sonard::bench {

/// Image against reference. Ratios are relative to the reference; "bins" are range lines.
struct ImageError {
  /// Root of the mean of (image / reference - 1)^2 over all bins whose reference is above 1e-2 of the largest
  /// of its beam, all beams pooled.
  double bin_rms = 0;
  /// The same without the worst 1 % of those bins.
  double bin_rms_trim = 0;
  /// Worst beam: distance of the two first echoes. The first echo is the range at which the echo summed from
  /// the sonar outwards, spread evenly inside a bin, reaches 1e-2 of the largest bin of the reference's beam.
  double first_echo_bins = 0;
  /// Share of the bins above 1e-2 (and above 1e-6) of the largest of their beam that are empty in the image:
  /// below a thousandth of their reference.
  double hole_fraction = 0;
  double hole_fraction_60db = 0;
  /// | sum of the beam / its reference - 1 |, of all beams that hear anything.
  double beam_total_mean = 0;
  double beam_total_worst = 0;
  std::uint64_t bins = 0;  ///< how many bins bin_rms is made of
};

/// Empty when the reference holds no echo at all. Both images have the same size.
/// @throws std::invalid_argument when they have not.
std::optional<ImageError> compare_images(const render::EchoImage& image, const render::EchoImage& reference);

/// How far one beam is from the truth.
struct BeamError {
  double total = 0;             ///< | sum of the beam / its reference - 1 |
  double centroid_lines = 0;    ///< distance of the two centroids
  double first_echo_lines = 0;  ///< ImageError::first_echo_bins of this beam
};

/// Of each beam that receives anything. Both images have the same size.
std::vector<BeamError> compare_beams(const render::EchoImage& image, const render::EchoImage& reference);

}  // namespace sonard::bench
