// SPDX-License-Identifier: Apache-2.0
// The strongest echo in the samples of a ping. Source: protocol/ping1d/README.md 3.4.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_job.hpp"
#include "protocol/ping1d/scan.hpp"

namespace sonard::ping1d {

/// What one ping shows.
struct Echo {
  std::vector<std::uint8_t> profile;  ///< a strength per point
  /// Where the strongest echo begins, in the head's millimetres; nullopt: no echo stands out of the noise.
  std::optional<double> distance_mm;
  double confidence_percent = 0.0;  ///< of this ping alone, 0..100
  int peak = 0;                     ///< strongest point beyond the ringing, 0..255
  int saturated = 0;                ///< points at 255 beyond the ringing
};

/// Codes of 16 bits are the fourth root of the amplitude, with this amplitude at the highest code: the shape
/// of an echo that saturates the profile still gives its exact distance.
inline constexpr double image_exponent = 0.25;
inline constexpr double image_full_scale = 4096.0;

/// Amplitudes, 1 at full scale of the profile, of an image with 8 bits (linear) or 16 bits.
std::vector<float> amplitudes(const PingImage& image);

/// Makes the profile of samples_of(scan, points), and finds the strongest echo. Echoes nearer than
/// `least_range_mm` do not count.
Echo find_echo(std::span<const float> amplitudes, const Scan& scan, int points, double least_range_mm);

}  // namespace sonard::ping1d
