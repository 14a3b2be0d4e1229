// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/surface_share.hpp"

#include <algorithm>
#include <cstddef>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr std::size_t lines_per_job = 128;

/// Replaces each number of `largest` by the candidate if that is larger.
SONARD_SIMD_CLONES
void keep_larger(const float* __restrict candidates, std::size_t count, float* __restrict largest) {
  for (std::size_t i = 0; i < count; ++i) {
    largest[i] = candidates[i] > largest[i] ? candidates[i] : largest[i];
  }
}

}  // namespace

std::vector<float> strongest_of_lines(const EchoImage& image, WorkerPool& workers) {
  const auto lines = static_cast<std::size_t>(image.bins);
  std::vector<float> strongest(lines, 0.0F);
  workers.run(static_cast<int>((lines + lines_per_job - 1) / lines_per_job), [&](int job) {
    const std::size_t first = static_cast<std::size_t>(job) * lines_per_job;
    const std::size_t count = std::min(lines_per_job, lines - first);
    for (std::size_t beam = 0; beam < static_cast<std::size_t>(image.beams); ++beam) {
      keep_larger(&image.intensity[beam * lines + first], count, &strongest[first]);
    }
  });
  return strongest;
}

void divide(std::vector<float>& of_surfaces, const std::vector<float>& of_all) {
  for (std::size_t i = 0; i < of_surfaces.size(); ++i) {
    of_surfaces[i] = of_all[i] > 0 ? of_surfaces[i] / of_all[i] : 0.0F;
  }
}

}  // namespace sonard::render
