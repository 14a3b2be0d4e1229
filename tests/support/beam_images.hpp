// SPDX-License-Identifier: Apache-2.0
// Images whose bins all follow from a formula.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

#include "renderer/ping.hpp"

namespace sonard::test {

/// Echo between two azimuths (the smaller first) from ranges [r1, r2).
using BeamEcho = std::function<double(double psi_from, double psi_to, double r1, double r2)>;

/// Computes `echo` for each bin of the ping, on several threads.
inline render::EchoImage image_of_beams(const render::SonarSettings& settings, const BeamEcho& echo) {
  const std::vector<double>& edges = settings.aperture.beam_edges_rad;
  const render::RangeBins& range = settings.range;
  render::EchoImage image{settings.aperture.beam_count(), range.count, {}};
  image.intensity.resize(static_cast<std::size_t>(image.beams) * static_cast<std::size_t>(image.bins));
  std::atomic<int> next_beam{0};
  const auto fill_beams = [&] {
    for (int beam = next_beam++; beam < image.beams; beam = next_beam++) {
      const auto b = static_cast<std::size_t>(beam);
      float* const values = &image.intensity[b * static_cast<std::size_t>(image.bins)];
      for (int k = 0; k < image.bins; ++k) {
        const double from_m = std::max(1e-9, k * range.step_m);
        values[k] = static_cast<float>(echo(edges[b + 1], edges[b], from_m, (k + 1) * range.step_m));
      }
    }
  };
  std::vector<std::jthread> helpers;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) {
    helpers.emplace_back(fill_beams);
  }
  fill_beams();
  helpers.clear();  // joins the threads; then the image is complete
  return image;
}

}  // namespace sonard::test
