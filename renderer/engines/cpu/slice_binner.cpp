// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_binner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "renderer/binning/beam_sums.hpp"

namespace sonard::render {

namespace {

BinningResult bin_slices_by_cones(const std::vector<const SliceCell*>& cells, const RangeLines& range,
                                  const BinningOptions& options, WorkerPool& workers,
                                  std::vector<float> memory) {
  std::vector<PatchColumn> columns;
  for (const SliceCell* cell : cells) {
    const double half = static_cast<double>(cell->slice.width_rad) / 2;
    columns.push_back({cell->slice.azimuth_rad + half, cell->slice.azimuth_rad - half, cell->patches.data(),
                       cell->patches.data() + cell->patches.size()});
  }
  return bin_by_cones(std::move(columns), range, options, workers, std::move(memory));
}

}  // namespace

BinningResult bin_echoes(const std::vector<const SliceCell*>& cells, const Aperture& aperture,
                         const RangeLines& range, const BinningOptions& options, WorkerPool& workers,
                         std::vector<float> memory) {
  if (options.cone_aperture != nullptr) {
    return bin_slices_by_cones(cells, range, options, workers, std::move(memory));
  }
  const int beams = aperture.beam_count();
  std::vector<std::size_t> begins(static_cast<std::size_t>(beams) + 1, cells.size());
  for (std::size_t i = cells.size(); i-- > 0;) {
    begins[static_cast<std::size_t>(cells[i]->beam)] = i;
  }
  const auto fill = [&](std::size_t beam, BeamSums& sums) {
    for (std::size_t i = begins[beam]; i < begins[beam + 1]; ++i) {
      for (const EchoPatch& patch : cells[i]->patches) {
        sums.add(patch);
      }
    }
  };
  // The bound of a mean's weights, or exactly what the beam sees.
  const double height =
      options.open_water ? aperture.pattern_height() : 2 * std::sin(aperture.elevation_limit_rad());
  // What the slices of a beam hold in fact: the echo of a bed at grazing incidence keeps its digits.
  const auto content = [&](std::size_t beam) {
    double echo = 0.0;
    for (std::size_t i = begins[beam]; i < begins[beam + 1]; ++i) {
      for (const EchoPatch& patch : cells[i]->patches) {
        echo += std::isfinite(patch.echo) ? static_cast<double>(patch.echo) : 0.0;
      }
    }
    return BeamContent{height * (aperture.beam_edges_rad[beam] - aperture.beam_edges_rad[beam + 1]), echo};
  };
  const auto empty = [&](std::size_t beam) {
    return options.skip.on(SkipRule::empty_beams) && !options.open_water &&
           std::all_of(cells.begin() + static_cast<std::ptrdiff_t>(begins[beam]),
                       cells.begin() + static_cast<std::ptrdiff_t>(begins[beam + 1]),
                       [](const SliceCell* cell) { return cell->patches.empty(); });
  };
  return bin_beams(beams, range, options, workers, std::move(memory), {empty, content, fill});
}

}  // namespace sonard::render
