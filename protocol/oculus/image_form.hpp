// SPDX-License-Identifier: Apache-2.0
// Size and sample layout of a ping's image. Source: protocol/oculus/README.md 3.2, 4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/oculus/messages.hpp"

namespace sonard::oculus {

/// Sample rate of a head in hertz, from the range steps of a recorded M1200d (4.6).
inline constexpr double sample_rate_hz = 37.5e6 / 143.0;
/// Default maximum number of rows of an image (4.6).
inline constexpr int usual_most_ranges = 1200;

/// Number of beams that a fire requests: 256 or 512.
int beams_of(const Fire& fire);
/// Sample width that a fire requests; 32 bits only with an extension.
DataSize data_size_of(const SimpleFire& fire);
std::size_t bytes_per_sample(DataSize size);
/// Bytes of a row: its gain, if there is one, and its samples.
std::size_t row_size(const PingResult& ping);
/// The samples of a ping with an image, row after row, without gains; the high bytes of wide samples.
std::vector<std::uint8_t> eight_bit_samples(const PingResult& ping);
/// Offset of the image in a ping message: the first multiple of 2048 after the bearings (4.3).
std::uint32_t usual_image_offset(bool second_version, int beams);

/// Bearings of the beams in hundredths of a degree, the most negative first: equally spaced in their sine,
/// rounded towards zero (4.5). Requires beams >= 2 and 0 < half_aperture_deg < 90.
std::vector<std::int16_t> bearings_cdeg(int beams, double half_aperture_deg);

/// Rows of an image.
struct RangeGrid {
  int ranges = 0;
  double resolution_m = 0.0;
};
/// The range grid for `range_m`. A row is the smallest multiple of a sample's one-way length that gives at
/// most `most_ranges` rows (4.6). All arguments must be positive.
RangeGrid range_grid(double range_m, double sound_speed_mps, int most_ranges = usual_most_ranges);

/// The exponent of the normalised amplitude for a gamma, gamma / 255; 1 for 0 (4.7).
double gamma_exponent(std::uint8_t gamma);

/// The gain that hardware reports: in the high-frequency mode 40 to 100 for 0 to 100 (4.4).
double reported_gain_percent(const Fire& fire);

/// Speed of sound in m/s at the water surface, from temperature and salinity (Medwin 1975).
double sound_speed_of_water_mps(double temperature_c, double salinity_ppt);

}  // namespace sonard::oculus
