// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/slices/first_slices.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::render {

namespace {

constexpr double most_sag_lines = 0.06;  // at `change` 1 %

/// Largest width of a first slice at an azimuth. Along a wall across the axis the range is d / cos psi, and
/// the echo is proportional to cos^3 psi. Within a slice, the change of the echo and the deviation of the
/// range from a straight line must stay within the accuracy.
double widest_first_slice(double azimuth_rad, double line_m, double sampled_range_m, double change) {
  const double tangent = std::abs(std::tan(std::min(std::abs(azimuth_rad), 1.4)));
  const double for_echo = change * std::sqrt(12.0) / (3 * tangent + 1e-9);
  const double sag_m = most_sag_lines * line_m * (change / 0.01);
  const double for_range = std::sqrt(8 * sag_m / (sampled_range_m * (1 + 2 * tangent * tangent)));
  return std::min({static_cast<double>(Fan::widest_slice), for_echo, std::max(for_range, for_echo / 4)});
}

}  // namespace

std::vector<FirstSlice> first_slices(const Fan& fan, double line_m, const SliceAccuracy& accuracy) {
  std::vector<FirstSlice> all;
  for (int beam = 0; beam < fan.beam_count(); ++beam) {
    const double port = fan.edge_rad(beam);
    const double width = port - fan.edge_rad(beam + 1);
    const double widest =
        widest_first_slice(port - width / 2, line_m, static_cast<double>(fan.sampled_range_m()),
                           static_cast<double>(accuracy.change));
    const int count = std::max(accuracy.slices_per_beam, static_cast<int>(std::ceil(width / widest - 1e-9)));
    for (int k = 0; k < count; ++k) {
      all.push_back({beam, port - width * (k + 0.5) / count, width / count});
    }
  }
  return all;
}

ProbeWeights probe_weights(const Aperture& aperture, float tan_limit) {
  std::array<double, slices::side_probes> pattern{};
  double sum = 0.0;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const float t = slices::probe_at(tan_limit, static_cast<int>(i));
    pattern[i] = aperture.elevation_weight(std::atan(static_cast<double>(t)));
    sum += pattern[i];
  }
  ProbeWeights weights{};
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const double share = static_cast<double>(pattern.size()) * pattern[i] / sum;
    weights[i] = static_cast<std::int32_t>(std::lround(static_cast<double>(probe_weight_unit) * share));
  }
  return weights;
}

}  // namespace sonard::render
