// SPDX-License-Identifier: Apache-2.0
// The echo of a flat bed in closed form, as samples of the renderer.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "protocol/common/ping_job.hpp"

namespace sonard::ping1d {

/// A bed below a head that looks straight down: the echo begins at `range_m` and ends where the beam does.
/// Its energy per metre falls with the sixth power of the range: spreading, Lambert's law and a beam.
struct Bed {
  double range_m = 0.0;
  double amplitude = 0.5;      ///< of the first sample, 1 at full scale
  double beam_end_rad = 0.26;  ///< half of the beam

  /// Energy from `range_m` to r, over the energy per metre at `range_m`.
  double energy_to(double r) const {
    const double end = std::clamp(r, range_m, range_m / std::cos(beam_end_rad));
    return range_m / 5.0 * (1.0 - std::pow(range_m / end, 5.0));
  }
  /// Amplitude of a sample.
  double sample(double from_m, double to_m) const {
    return amplitude * std::sqrt(std::max(0.0, energy_to(to_m) - energy_to(from_m)) / (to_m - from_m));
  }
};

/// An amplitude as the renderer codes it in 16 bits: its fourth root, 4096 at the highest code, rounded down.
inline std::uint16_t code_of(double amplitude) {
  return static_cast<std::uint16_t>(std::min(65534.0, 65535.0 * std::pow(amplitude / 4096.0, 0.25)));
}

/// Adds a bed to a 16-bit image of a job.
inline void add(const Bed& bed, const PingJob& job, PingImage& image) {
  image.number = job.number;
  image.u16.resize(static_cast<std::size_t>(job.bins()));
  for (std::size_t k = 0; k < image.u16.size(); ++k) {
    const auto bin = static_cast<double>(k);
    const double before = 4096.0 * std::pow(image.u16[k] / 65535.0, 4.0);
    image.u16[k] = code_of(before + bed.sample(bin * job.bin_m(), (bin + 1.0) * job.bin_m()));
  }
}

inline PingImage image_of(const PingJob& job, const Bed& bed) {
  PingImage image;
  add(bed, job, image);
  return image;
}

}  // namespace sonard::ping1d
