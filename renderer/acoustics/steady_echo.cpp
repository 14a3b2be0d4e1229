// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/steady_echo.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr std::size_t most_points = 256;
// Share of the mixed intensity above which a spot is a point in part, and from which it is one entirely.
constexpr float least_dominance = 0.5F;
constexpr float full_dominance = 0.8F;

/// Sum over a rectangle around a cell, as far as it lies in the image.
float sum_around(const EchoImage& fine, int fine_beam, int line, int beams, int lines) {
  float sum = 0;
  for (int f = std::max(0, fine_beam - beams); f <= std::min(fine.beams - 1, fine_beam + beams); ++f) {
    const float* row = &fine.intensity[static_cast<std::size_t>(f) * static_cast<std::size_t>(fine.bins)];
    for (int k = std::max(0, line - lines); k <= std::min(fine.bins - 1, line + lines); ++k) {
      sum += row[k];
    }
  }
  return sum;
}

bool is_peak(const EchoImage& fine, int fine_beam, int line) {
  const float here = fine.at(fine_beam, line);
  for (int f = std::max(0, fine_beam - 1); f <= std::min(fine.beams - 1, fine_beam + 1); ++f) {
    for (int k = std::max(0, line - 1); k <= std::min(fine.bins - 1, line + 1); ++k) {
      const float there = fine.at(f, k);
      const bool first = f < fine_beam || (f == fine_beam && k < line);
      if (there > here || (first && there == here)) {
        return false;
      }
    }
  }
  return true;
}

/// Share of a spot that is steady; it rises smoothly from 0 to 1.
float steady_share(const EchoImage& fine, int fine_beam, int line, const MixingReach& reach) {
  const float spot = sum_around(fine, fine_beam, line, 1, 1);
  const float all = sum_around(fine, fine_beam, line, reach.fine_beams, reach.lines);
  const float x = std::clamp((spot / all - least_dominance) / (full_dominance - least_dominance), 0.0F, 1.0F);
  return x * x * (3 - 2 * x);
}

constexpr int block_lines = 32;

/// True if any line of a block is far above the lines beside its spot; few blocks have one.
SONARD_SIMD_CLONES
bool stands_out(const float* __restrict row, float faintest) {
  int any = 0;
  for (int k = 0; k < block_lines; ++k) {
    any |= static_cast<int>(row[k] > faintest) & static_cast<int>(row[k] > 2 * (row[k - 2] + row[k + 2]));
  }
  return any != 0;
}

void find_points_of_beam(const EchoImage& fine, int fine_beam, const MixingReach& reach, float faintest,
                         std::vector<PointEcho>& points) {
  const float* row =
      &fine.intensity[static_cast<std::size_t>(fine_beam) * static_cast<std::size_t>(fine.bins)];
  for (int k = 2; k + 2 < fine.bins; ++k) {
    if ((k - 2) % block_lines == 0 && k + block_lines + 2 <= fine.bins && !stands_out(row + k, faintest)) {
      k += block_lines - 1;
      continue;
    }
    if (!(row[k] > faintest) || !(row[k] > 2 * (row[k - 2] + row[k + 2])) || !is_peak(fine, fine_beam, k)) {
      continue;
    }
    if (const float share = steady_share(fine, fine_beam, k, reach); share > 0) {
      points.push_back({fine_beam, k, share});
    }
  }
}

}  // namespace

MixingReach mixing_reach(const SonarSettings& settings) {
  const Aperture& aperture = settings.aperture;
  const std::vector<double>& edges = aperture.beam_edges_rad;
  const double fine_sine = (std::sin(edges.front()) - std::sin(edges.back())) /
                           (aperture.beam_count() * static_cast<double>(aperture.fine_beams));
  const double lines = settings.physical.pulse.range_cell_m / settings.range.step_m;
  return {std::max(2, static_cast<int>(std::lround(aperture.receive_beamwidth_rad / fine_sine))),
          std::max(2, static_cast<int>(std::lround(lines)))};
}

std::vector<PointEcho> find_points(const EchoImage& fine, const MixingReach& reach, float faintest,
                                   WorkerPool& workers) {
  constexpr int beams_per_job = 16;
  const int jobs = (fine.beams + beams_per_job - 1) / beams_per_job;
  std::vector<std::vector<PointEcho>> found(static_cast<std::size_t>(jobs));
  workers.run(jobs, [&](int job) {
    const int end = std::min(fine.beams, (job + 1) * beams_per_job);
    for (int f = job * beams_per_job; f < end; ++f) {
      find_points_of_beam(fine, f, reach, faintest, found[static_cast<std::size_t>(job)]);
    }
  });
  std::vector<PointEcho> points;
  for (const std::vector<PointEcho>& some : found) {
    points.insert(points.end(), some.begin(), some.end());
  }
  if (points.size() > most_points) {
    const auto stronger = [&](const PointEcho& a, const PointEcho& b) {
      return fine.at(a.fine_beam, a.line) > fine.at(b.fine_beam, b.line);
    };
    std::ranges::nth_element(points, points.begin() + most_points, stronger);
    points.resize(most_points);
  }
  return points;
}

SteadyEcho receive_points(const std::vector<PointEcho>& points, const EchoImage& fine,
                          const BeamPattern& pattern, const PulseResponse* pulse, int beams) {
  SteadyEcho steady;
  if (points.empty()) {
    return steady;
  }
  steady.row_of_line.assign(static_cast<std::size_t>(fine.bins), -1);
  const int taps = pulse != nullptr ? pulse->taps() : 1;
  const auto row_at = [&](int line) {
    std::int32_t& row = steady.row_of_line[static_cast<std::size_t>(line)];
    if (row < 0) {
      row = static_cast<std::int32_t>(steady.intensity.size() / static_cast<std::size_t>(beams));
      steady.intensity.resize(steady.intensity.size() + static_cast<std::size_t>(beams), 0.0F);
    }
    return &steady.intensity[static_cast<std::size_t>(row) * static_cast<std::size_t>(beams)];
  };
  std::vector<float> received(static_cast<std::size_t>(beams));
  for (const PointEcho& point : points) {
    const int first = std::max(0, point.fine_beam - 1);
    const int last = std::min(fine.beams - 1, point.fine_beam + 1);
    const BeamPattern::Beams lobes = pattern.receivers_of(first, last);
    for (int k = std::max(0, point.line - 1); k <= std::min(fine.bins - 1, point.line + 1); ++k) {
      std::fill(received.begin() + lobes.begin, received.begin() + lobes.end, 0.0F);
      for (int f = first; f <= last; ++f) {
        pattern.add_lobe(f, point.share * fine.at(f, k), lobes, received);
      }
      for (int line = std::max(0, k - taps + 1); line <= std::min(fine.bins - 1, k + taps - 1); ++line) {
        const auto of_pulse = static_cast<float>(pulse != nullptr ? pulse->share(std::abs(line - k)) : 1.0);
        float* row = row_at(line);
        for (int b = lobes.begin; b < lobes.end; ++b) {
          // Negative in nulls beside the main lobe: there the array receives less than the mean leak.
          row[b] += of_pulse * std::max(received[static_cast<std::size_t>(b)], 0.0F);
        }
      }
    }
  }
  return steady;
}

}  // namespace sonard::render
