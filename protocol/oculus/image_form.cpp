// SPDX-License-Identifier: Apache-2.0
#include "protocol/oculus/image_form.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace sonard::oculus {

int beams_of(const Fire& fire) {
  return (fire.flags & fire_flags::beams_512) != 0 ? 512 : 256;
}

DataSize data_size_of(const SimpleFire& fire) {
  if (fire.extension && (fire.extension->flags & extension_flags::thirty_two_bit) != 0) {
    return DataSize::bits_32;
  }
  return (fire.fire.flags & fire_flags::sixteen_bit) != 0 ? DataSize::bits_16 : DataSize::bits_8;
}

std::size_t bytes_per_sample(DataSize size) {
  return static_cast<std::size_t>(size) + 1;
}

std::size_t row_size(const PingResult& ping) {
  const std::size_t gain = (ping.fire.fire.flags & fire_flags::row_gains) != 0 ? 4 : 0;
  return ping.beams * bytes_per_sample(ping.data_size) + gain;
}

std::vector<std::uint8_t> eight_bit_samples(const PingResult& ping) {
  const std::size_t width = bytes_per_sample(ping.data_size);
  const std::size_t row = row_size(ping);
  std::vector<std::uint8_t> samples;
  samples.reserve(std::size_t{ping.ranges} * ping.beams);
  for (std::size_t range = 0; range < ping.ranges; ++range) {
    const std::size_t first = (range + 1) * row - ping.beams * width;  // after the gain, if there is one
    for (std::size_t beam = 0; beam < ping.beams; ++beam) {
      samples.push_back(ping.image[first + beam * width + width - 1]);
    }
  }
  return samples;
}

std::uint32_t usual_image_offset(bool second_version, int beams) {
  constexpr std::size_t step = 2048;
  const std::size_t end =
      (second_version ? result_v2_size : result_v1_size) + 2 * static_cast<std::size_t>(beams);
  return static_cast<std::uint32_t>((end + step - 1) / step * step);
}

std::vector<std::int16_t> bearings_cdeg(int beams, double half_aperture_deg) {
  assert(beams >= 2 && half_aperture_deg > 0.0 && half_aperture_deg < 90.0);
  constexpr double degree = std::numbers::pi / 180.0;
  const double edge = std::sin(half_aperture_deg * degree);
  std::vector<std::int16_t> bearings;
  bearings.reserve(static_cast<std::size_t>(beams));
  for (int beam = 0; beam < beams; ++beam) {
    const double sine = edge * (2.0 * beam / (beams - 1) - 1.0);
    bearings.push_back(static_cast<std::int16_t>(100.0 * std::asin(sine) / degree));
  }
  bearings.back() = static_cast<std::int16_t>(std::lround(100.0 * half_aperture_deg));
  bearings.front() = static_cast<std::int16_t>(-bearings.back());
  return bearings;
}

RangeGrid range_grid(double range_m, double sound_speed_mps, int most_ranges) {
  assert(range_m > 0.0 && sound_speed_mps > 0.0 && most_ranges > 0);
  const double sample_m = sound_speed_mps / (2.0 * sample_rate_hz);
  const auto rows = [&](double samples) { return std::floor(range_m / (samples * sample_m)); };
  double samples = std::max(1.0, std::floor(range_m / (sample_m * (most_ranges + 1.0))));
  while (rows(samples) > most_ranges) {
    samples += 1.0;
  }
  return {std::max(1, static_cast<int>(rows(samples))), samples * sample_m};
}

double gamma_exponent(std::uint8_t gamma) {
  return gamma == 0 ? 1.0 : gamma / 255.0;
}

double reported_gain_percent(const Fire& fire) {
  return fire.master_mode == 1 ? fire.gain_percent : 40.0 + 0.6 * fire.gain_percent;
}

double sound_speed_of_water_mps(double temperature_c, double salinity_ppt) {
  const double t = temperature_c;
  return 1449.2 + 4.6 * t - 0.055 * t * t + 0.00029 * t * t * t + (1.34 - 0.010 * t) * (salinity_ppt - 35.0);
}

}  // namespace sonard::oculus
