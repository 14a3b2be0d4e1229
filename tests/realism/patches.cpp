// SPDX-License-Identifier: Apache-2.0
#include "tests/realism/patches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "tests/realism/statistics.hpp"

namespace sonard::realism {
namespace {

constexpr double most_off_sd = 0.6;
constexpr double most_clipped = 0.02;

using Values = std::vector<double>;  ///< of a patch, line after line

double beam_offset(std::size_t i) {
  return static_cast<double>(i % patch_beams) - (patch_beams - 1) / 2.0;
}
double line_offset(std::size_t i) {
  return static_cast<double>(i / patch_beams) - (patch_lines - 1) / 2.0;
}

/// Standard deviation from the least-squares plane. Offsets from the middle of a patch are orthogonal, so
/// each slope is fitted separately.
double sd_off_plane(const Values& values) {
  const double mean = mean_of(values);
  double along_beams = 0, along_lines = 0, beam_square = 0, line_square = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    along_beams += beam_offset(i) * values[i];
    along_lines += line_offset(i) * values[i];
    beam_square += beam_offset(i) * beam_offset(i);
    line_square += line_offset(i) * line_offset(i);
  }
  double square = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double plane =
        mean + along_beams / beam_square * beam_offset(i) + along_lines / line_square * line_offset(i);
    square += (values[i] - plane) * (values[i] - plane);
  }
  return std::sqrt(square / static_cast<double>(values.size()));
}

bool is_clipped(const Values& values, double full_scale) {
  const auto clipped =
      std::ranges::count_if(values, [&](double value) { return value <= 0 || value >= full_scale; });
  return static_cast<double>(clipped) > most_clipped * static_cast<double>(values.size());
}

bool is_even(const Values& values, double sd) {
  std::array<double, 4> means{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t quadrant = (beam_offset(i) > 0 ? 1 : 0) + (line_offset(i) > 0 ? 2 : 0);
    means[quadrant] += values[i] * 4 / static_cast<double>(values.size());
  }
  const double mean = mean_of(values);
  return std::ranges::all_of(means, [&](double of) { return std::abs(of - mean) < most_off_sd * sd; });
}

}  // namespace

std::vector<Patch> homogeneous_patches(const AmplitudeImage& image) {
  std::vector<Patch> patches;
  Values amplitude(static_cast<std::size_t>(patch_beams) * patch_lines), intensity(amplitude.size());
  for (int line = 0; line + patch_lines <= image.lines; line += patch_lines) {
    for (int beam = 0; beam + patch_beams <= image.beams; beam += patch_beams) {
      for (std::size_t i = 0; i < amplitude.size(); ++i) {
        const int at = (line + static_cast<int>(i) / patch_beams) * image.beams + beam +
                       static_cast<int>(i) % patch_beams;
        amplitude[i] = image.amplitude[static_cast<std::size_t>(at)];
        intensity[i] = amplitude[i] * amplitude[i];
      }
      const double sd = sd_off_plane(amplitude);
      if (!is_clipped(amplitude, image.full_scale) && is_even(amplitude, sd)) {
        const double mean = mean_of(amplitude);
        patches.push_back({mean, sd / mean, std::pow(sd_off_plane(intensity) / mean_of(intensity), 2)});
      }
    }
  }
  std::ranges::sort(patches, {}, &Patch::mean);
  return patches;
}

Patch median_of(const std::vector<Patch>& patches, Third third) {
  const std::size_t size = patches.size() / 3;
  if (size == 0) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan};
  }
  const std::size_t begin = static_cast<std::size_t>(third) * size;
  const std::size_t end = third == Third::bright ? patches.size() : begin + size;
  const auto median = [&](double Patch::*of) {
    Values values;
    for (std::size_t i = begin; i < end; ++i) {
      values.push_back(patches[i].*of);
    }
    return quantile_of(std::move(values), 0.5);
  };
  return {median(&Patch::mean), median(&Patch::variation), median(&Patch::index)};
}

}  // namespace sonard::realism
