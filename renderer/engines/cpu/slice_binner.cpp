// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_binner.hpp"

#include <atomic>
#include <cstdint>
#include <span>
#include <utility>

#include "renderer/binning/beam_sums.hpp"
#include "renderer/stopwatch.hpp"

namespace sonard::render {

namespace {

constexpr int enough_beams = 8;  // with fewer beams, threads would be idle

/// Prefetches the next slice while one is shaded, because all slices together exceed the caches.
void fetch(const SliceCell& cell) {
  for (const VisibleSegment& segment : cell.visible) {
    __builtin_prefetch(&segment);
  }
}

/// Makes patches in the calling threads and sums the time of all of them.
class Shading {
 public:
  explicit Shading(const SliceSampler& slices) : slices_(slices) {}

  void append(std::span<const SliceCell* const> cells, std::vector<EchoPatch>& patches) {
    Stopwatch watch;
    std::uint64_t without_facets = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i + 1 < cells.size()) {
        fetch(*cells[i + 1]);
      }
      without_facets += slices_.make_patches(*cells[i], patches);
    }
    without_facets_ += without_facets;
    seconds_ += watch.lap();
  }

  std::uint64_t without_facets() const { return without_facets_; }
  double seconds() const { return seconds_; }  ///< of all threads

 private:
  const SliceSampler& slices_;
  std::atomic<std::uint64_t> without_facets_{0};
  std::atomic<double> seconds_{0.0};
};

using PatchesOfCells = std::vector<std::vector<EchoPatch>>;

PatchesOfCells all_patches(Shading& shading, std::span<const SliceCell* const> cells, WorkerPool& workers) {
  PatchesOfCells patches(cells.size());
  workers.run(static_cast<int>(cells.size()), [&](int i) {
    const auto cell = static_cast<std::size_t>(i);
    shading.append(cells.subspan(cell, 1), patches[cell]);
  });
  return patches;
}

BinningResult bin_slices_by_cones(Shading& shading, std::span<const SliceCell* const> cells,
                                  const RangeBins& range, const BinningOptions& options, WorkerPool& workers,
                                  std::vector<float> memory) {
  const PatchesOfCells patches = all_patches(shading, cells, workers);
  std::vector<PatchColumn> columns;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Slice& slice = cells[i]->slice;
    const double half = static_cast<double>(slice.width_rad) / 2;
    columns.push_back({slice.azimuth_rad + half, slice.azimuth_rad - half, patches[i].data(),
                       patches[i].data() + patches[i].size()});
  }
  return bin_by_cones(std::move(columns), range, options, workers, std::move(memory));
}

/// Groups cells by beam. @param cells from port to starboard
std::vector<std::span<const SliceCell* const>> cells_by_beam(std::span<const SliceCell* const> cells,
                                                             int beams) {
  std::vector<std::span<const SliceCell* const>> by_beam(static_cast<std::size_t>(beams));
  for (std::size_t begin = 0, end = 0; begin < cells.size(); begin = end) {
    while (end < cells.size() && cells[end]->beam == cells[begin]->beam) {
      ++end;
    }
    by_beam[static_cast<std::size_t>(cells[begin]->beam)] = cells.subspan(begin, end - begin);
  }
  return by_beam;
}

BinningResult bin_slices_by_beam(Shading& shading, std::span<const SliceCell* const> cells,
                                 const Aperture& aperture, const RangeBins& range,
                                 const BinningOptions& options, WorkerPool& workers,
                                 std::vector<float> memory) {
  const auto by_beam = cells_by_beam(cells, aperture.beam_count());
  if (aperture.beam_count() >= enough_beams) {
    return bin_patches(
        aperture, range, options, workers, std::move(memory),
        [&](std::size_t beam, std::vector<EchoPatch>& patches) { shading.append(by_beam[beam], patches); });
  }
  const PatchesOfCells made = all_patches(shading, cells, workers);
  return bin_patches(aperture, range, options, workers, std::move(memory),
                     [&](std::size_t beam, std::vector<EchoPatch>& patches) {
                       const auto first = by_beam[beam].data() - cells.data();
                       for (std::size_t i = 0; i < by_beam[beam].size(); ++i) {
                         const auto& of_cell = made[static_cast<std::size_t>(first) + i];
                         patches.insert(patches.end(), of_cell.begin(), of_cell.end());
                       }
                     });
}

}  // namespace

BinningResult bin_echoes(const SliceSampler& slices, const std::vector<const SliceCell*>& cells,
                         const Aperture& aperture, const RangeBins& range, const BinningOptions& options,
                         WorkerPool& workers, std::vector<float> memory) {
  Shading shading(slices);
  BinningResult result =
      options.cone_aperture != nullptr
          ? bin_slices_by_cones(shading, cells, range, options, workers, std::move(memory))
          : bin_slices_by_beam(shading, cells, aperture, range, options, workers, std::move(memory));
  result.skipped.add(SkipRule::facet_kernel, shading.without_facets());
  result.shading_s = shading.seconds() / workers.size();
  return result;
}

SeenPatches see_patches(const SliceSampler& slices, const std::vector<const SliceCell*>& cells,
                        WorkerPool& workers) {
  Shading shading(slices);
  const PatchesOfCells made = all_patches(shading, cells, workers);
  SeenPatches seen;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    seen.patches.insert(seen.patches.end(), made[i].begin(), made[i].end());
    seen.wedges.push_back({cells[i]->slice.azimuth_rad, seen.patches.size()});
  }
  return seen;
}

}  // namespace sonard::render
