// SPDX-License-Identifier: Apache-2.0
#include "renderer/sample_grid/grid_binner.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <utility>

#include "renderer/binning/beam_sums.hpp"
#include "renderer/sample_grid/range_plane.hpp"

namespace sonard::render {

namespace {

/// The part of a pixel that counts: a parallelogram, its centre relative to the pixel's, tangent units.
struct Cell {
  float x_offset, y_offset, width, height;
  float slope;  ///< dy/dx of its upper and lower side
};

/// The echo of `cell` of the pixel at tangents (x, y), spread evenly and independently along its two sides.
/// If they reached behind the sonar, the surface is seen edge-on and fills little of the cell: it stays at
/// its range.
EchoPatch patch_of(const SurfaceSample& sample, float x, float y, const Cell& cell, float weight) {
  RangePlane plane{sample.range_m, sample.range_dx, sample.range_dy};
  if (cell.x_offset != 0 || cell.y_offset != 0) {
    plane.move(x, y, cell.x_offset, cell.y_offset);
  }
  float across = std::abs(plane.dx + cell.slope * plane.dy) * cell.width;
  float along = std::abs(plane.dy) * cell.height;
  if (across + along > 2 * plane.range) {
    across = along = 0;
  }
  const float spread = std::max(across, along);
  const float side = x + cell.x_offset;
  const float tangent = (y + cell.y_offset) / std::sqrt(1 + side * side);
  const float smear = std::min(across, along);
  return {plane.range - 0.5F * spread,
          plane.range + 0.5F * spread,
          smear,
          smear,
          weight * sample.response,
          weight,
          0.0F,
          0.0F,
          tangent,
          tangent};
}

/// Makes the patches of one column of one beam, cut at the beam's edges and the elevation limit. A pixel
/// covers the range span of its cell on the plane that it hit (docs/physics.md 2.3).
/// @return number of samples marked invalid
std::uint64_t make_patches(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                           const ColumnPart& part, const float* weights, std::vector<EchoPatch>& patches) {
  const SubView& view = grid.views[static_cast<std::size_t>(part.view)];
  const SurfaceSample* column = views[static_cast<std::size_t>(part.view)] + part.column;
  const auto x = static_cast<float>(-view.tan_half_width + (part.column + 0.5) * view.pixel_width());
  const auto bottom = static_cast<float>(-view.tan_half_height + 0.5 * view.pixel_height());
  const auto pixel_height = static_cast<float>(view.pixel_height());
  std::uint64_t invalid = 0;
  patches.clear();
  for (int row = part.row_begin; row < part.row_end; ++row) {
    const SurfaceSample& sample = column[static_cast<std::ptrdiff_t>(row) * view.columns];
    if (!(sample.range_m > 0)) {
      invalid += sample.range_m < 0 ? 1 : 0;
      continue;
    }
    Cell cell{part.x_offset, 0.0F, part.width, pixel_height, 0.0F};
    if (row == part.row_begin) {
      cell = {part.x_offset, part.first_y_offset, part.width, part.first_height, -part.limit_slope};
    } else if (row + 1 == part.row_end) {
      cell = {part.x_offset, part.last_y_offset, part.width, part.last_height, part.limit_slope};
    }
    const float y = bottom + static_cast<float>(row) * pixel_height;
    patches.push_back(patch_of(sample, x, y, cell, weights[row - part.row_begin]));
  }
  return invalid;
}

void add_points(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                const ColumnPart& part, const float* weights, double lines_per_m, BeamSums& sums) {
  const SubView& view = grid.views[static_cast<std::size_t>(part.view)];
  const SurfaceSample* column = views[static_cast<std::size_t>(part.view)] + part.column;
  for (int row = part.row_begin; row < part.row_end; ++row) {
    const SurfaceSample& sample = column[static_cast<std::ptrdiff_t>(row) * view.columns];
    const float weight = weights[row - part.row_begin];
    if (sample.range_m > 0) {
      sums.add_point(std::floor(static_cast<double>(sample.range_m) * lines_per_m), weight * sample.response,
                     weight);
    }
    sums.invalid += sample.range_m < 0 ? 1 : 0;
  }
}

/// Azimuths and patches of a part of a column.
PatchColumn column_of(const SampleGrid& grid, const ColumnPart& part, const std::vector<EchoPatch>& patches) {
  return {grid.port_rad(part), grid.starboard_rad(part), patches.data(), patches.data() + patches.size()};
}

BinningResult bin_grid_by_cones(const SampleGrid& grid, const CellWeights& weights,
                                const std::vector<const SurfaceSample*>& views, const RangeBins& range,
                                const BinningOptions& options, WorkerPool& workers,
                                std::vector<float> memory) {
  std::vector<std::vector<EchoPatch>> patches(grid.parts.size());
  std::atomic<std::uint64_t> invalid{0};
  workers.run(static_cast<int>(grid.parts.size()), [&](int p) {
    const auto part = static_cast<std::size_t>(p);
    invalid += make_patches(grid, views, grid.parts[part], weights.of(part), patches[part]);
  });
  std::vector<PatchColumn> columns;
  for (std::size_t part = 0; part < grid.parts.size(); ++part) {
    columns.push_back(column_of(grid, grid.parts[part], patches[part]));
  }
  BinningResult result = bin_by_cones(std::move(columns), range, options, workers, std::move(memory));
  result.invalid_samples += invalid;
  return result;
}

}  // namespace

BinningResult bin_samples(const SampleGrid& grid, const CellWeights& weights,
                          const std::vector<const SurfaceSample*>& views, const RangeBins& range,
                          const BinningOptions& options, WorkerPool& workers, std::vector<float> memory) {
  if (options.cone_aperture != nullptr) {
    return bin_grid_by_cones(grid, weights, views, range, options, workers, std::move(memory));
  }
  const double legacy_scale = options.legacy_bin_index ? (range.count - 1.0) / range.count : 1.0;
  const auto fill = [&](std::size_t beam, BeamSums& sums) {
    const double solid_angle = weights.sum(static_cast<std::size_t>(grid.beam_parts[beam]),
                                           static_cast<std::size_t>(grid.beam_parts[beam + 1]));
    sums.reset(range, solid_angle, solid_angle * static_cast<double>(options.largest_response), options);
    for (int p = grid.beam_parts[beam]; p < grid.beam_parts[beam + 1]; ++p) {
      const auto index = static_cast<std::size_t>(p);
      const ColumnPart& part = grid.parts[index];
      if (options.footprint) {
        thread_local std::vector<EchoPatch> patches;
        sums.invalid += make_patches(grid, views, part, weights.of(index), patches);
        for (const EchoPatch& patch : patches) {
          sums.add(patch);
        }
      } else {
        add_points(grid, views, part, weights.of(index), legacy_scale / range.step_m, sums);
      }
    }
    return true;
  };
  return bin_beams(grid.beam_count(), range, options, workers, std::move(memory), fill);
}

}  // namespace sonard::render
