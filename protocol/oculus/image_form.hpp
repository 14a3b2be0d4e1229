// SPDX-License-Identifier: Apache-2.0
// What shape the image of a ping has, and where its samples lie. Source: docs/protocols/oculus.md 3.2, 4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/oculus/messages.hpp"

namespace sonard::oculus {

/// Rate of the samples of a head in hertz, from the steps of a recorded M1200d (4.6).
inline constexpr double sample_rate_hz = 37.5e6 / 143.0;
/// Rows of an image at most, unless the configuration says otherwise (4.6).
inline constexpr int usual_most_ranges = 1200;

/// 256 or 512, as a fire asks.
int beams_of(const Fire& fire);
/// 32 bits need an extension that asks for them.
DataSize data_size_of(const SimpleFire& fire);
std::size_t bytes_per_sample(DataSize size);
/// Bytes of a row: its gain, where there is one, and its samples.
std::size_t row_size(const PingResult& ping);
/// The samples of a ping that has its image, row after row, without gains: of wide ones the high byte.
std::vector<std::uint8_t> eight_bit_samples(const PingResult& ping);
/// Where the image of a ping begins: the first multiple of 2048 behind the bearings (4.3).
std::uint32_t usual_image_offset(bool second_version, int beams);

/// Bearings of the beams in hundredths of a degree, the most negative first: equally spaced in their sine,
/// rounded towards zero (4.5). Requires beams >= 2 and 0 < half_aperture_deg < 90.
std::vector<std::int16_t> bearings_cdeg(int beams, double half_aperture_deg);

/// Rows of an image.
struct RangeGrid {
  int ranges = 0;
  double resolution_m = 0.0;
};
/// As many rows as fit in `range_m`, each the least multiple of half a sample's way by which there are at
/// most `most_ranges` (4.6). Requires all to be positive.
RangeGrid range_grid(double range_m, double sound_speed_mps, int most_ranges = usual_most_ranges);

/// The exponent of the normalised amplitude that a gamma asks for: 0 and 255 are 1 (4.7).
double gamma_exponent(std::uint8_t gamma);

/// The gain that a ping reports: hardware reports 40 to 100 for 0 to 100 in the high-frequency mode (4.4).
double reported_gain_percent(const Fire& fire);

/// Speed of sound in metres per second at the surface, from temperature and salinity (Medwin 1975).
double sound_speed_of_water_mps(double temperature_c, double salinity_ppt);

}  // namespace sonard::oculus
