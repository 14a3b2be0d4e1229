// SPDX-License-Identifier: Apache-2.0
#include "renderer/binning/beam_sums.hpp"

#include <atomic>
#include <utility>

namespace sonard::render {

BinningResult bin_beams(int beams, const RangeLines& range, const BinningOptions& options,
                        WorkerPool& workers, std::vector<float> memory, const BeamSource& source) {
  BinningResult result;
  result.echo = std::move(memory);
  result.beams = beams;
  result.lines = range.count;
  const auto lines = static_cast<std::size_t>(range.count);
  result.echo.resize(static_cast<std::size_t>(beams) * lines);
  result.open_sr.resize(options.open_water ? result.echo.size() : 0);
  std::atomic<std::uint64_t> samples{0};
  std::atomic<std::uint64_t> invalid{0};
  std::atomic<std::uint64_t> empty_beams{0};
  workers.run(beams, [&](int beam) {
    thread_local BeamSums sums;
    const auto b = static_cast<std::size_t>(beam);
    if (source.is_empty(b)) {
      ++empty_beams;
      std::fill_n(&result.echo[b * lines], lines, 0.0F);
      return;  // an empty beam is not asked for its open water
    }
    const BeamContent most = source.content(b);
    sums.reset(range, most.solid_angle, most.echo, options);
    source.fill(b, sums);
    sums.read(lines, &result.echo[b * lines]);
    if (options.open_water) {
      sums.read_open(&result.open_sr[b * lines]);
    }
    samples += sums.samples;
    invalid += sums.invalid;
  });
  result.samples = samples;
  result.invalid_samples = invalid;
  result.skipped.add(SkipRule::empty_beams, empty_beams);
  return result;
}

namespace {

/// Memory of the thread for the one beam that it is at.
std::vector<EchoPatch>& patches_of_this_beam() {
  thread_local std::vector<EchoPatch> patches;
  return patches;
}

}  // namespace

BinningResult bin_by_cones(std::vector<PatchColumn> columns, const RangeLines& range,
                           const BinningOptions& options, WorkerPool& workers, std::vector<float> memory) {
  const Aperture& aperture = *options.cone_aperture;
  const ConeBearings bearings(aperture, std::move(columns));
  const double height =
      options.open_water ? aperture.pattern_height() : 2 * std::sin(aperture.elevation_limit_rad());
  const BeamSource source{[](std::size_t) { return false; },
                          [&](std::size_t beam) {
                            std::vector<EchoPatch>& patches = patches_of_this_beam();
                            bearings.patches_of(static_cast<int>(beam), patches);
                            double echo = 0.0;
                            for (const EchoPatch& patch : patches) {
                              echo += std::isfinite(patch.echo) ? static_cast<double>(patch.echo) : 0.0;
                            }
                            return BeamContent{
                                height * (aperture.beam_edges_rad[beam] - aperture.beam_edges_rad[beam + 1]),
                                echo};
                          },
                          [&](std::size_t, BeamSums& sums) {
                            for (const EchoPatch& patch : patches_of_this_beam()) {
                              sums.add(patch);
                            }
                          }};
  return bin_beams(aperture.beam_count(), range, options, workers, std::move(memory), source);
}

}  // namespace sonard::render
