// SPDX-License-Identifier: Apache-2.0
#include "renderer/binning/beam_sums.hpp"

#include <atomic>
#include <utility>

namespace sonard::render {

BinningResult bin_beams(int beams, const RangeBins& range, const BinningOptions& options, WorkerPool& workers,
                        std::vector<float> memory, const FillBeam& fill) {
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
    if (!fill(b, sums)) {
      ++empty_beams;
      std::fill_n(&result.echo[b * lines], lines, 0.0F);
      return;  // fill() returns false only if open water is not requested
    }
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

BinningResult bin_patches(const Aperture& aperture, const RangeBins& range, const BinningOptions& options,
                          WorkerPool& workers, std::vector<float> memory, const PatchesOfBeam& patches_of) {
  // Upper bound of the weights of a mean, or the exact solid angle of the beam.
  const double height =
      options.open_water ? aperture.pattern_height() : 2 * std::sin(aperture.elevation_limit_rad());
  const auto fill = [&](std::size_t beam, BeamSums& sums) {
    thread_local std::vector<EchoPatch> patches;
    patches.clear();
    patches_of(beam, patches);
    if (options.skip.on(SkipRule::empty_beams) && !options.open_water && patches.empty()) {
      return false;
    }
    // The actual echo of the beam as bound, so that weak echoes of a bed at grazing incidence keep their
    // digits.
    double echo = 0.0;
    for (const EchoPatch& patch : patches) {
      echo += std::isfinite(patch.echo) ? static_cast<double>(patch.echo) : 0.0;
    }
    const double width = aperture.beam_edges_rad[beam] - aperture.beam_edges_rad[beam + 1];
    sums.reset(range, height * width, echo, options);
    for (const EchoPatch& patch : patches) {
      sums.add(patch);
    }
    return true;
  };
  return bin_beams(aperture.beam_count(), range, options, workers, std::move(memory), fill);
}

BinningResult bin_by_cones(std::vector<PatchColumn> columns, const RangeBins& range,
                           const BinningOptions& options, WorkerPool& workers, std::vector<float> memory) {
  const ConeBearings bearings(*options.cone_aperture, std::move(columns));
  return bin_patches(*options.cone_aperture, range, options, workers, std::move(memory),
                     [&](std::size_t beam, std::vector<EchoPatch>& patches) {
                       bearings.patches_of(static_cast<int>(beam), patches);
                     });
}

}  // namespace sonard::render
