#include "renderer/sample_grid/grid_patches.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/sample_grid/range_plane.hpp"

namespace sonard::render {

namespace {

/// What of a pixel counts: a parallelogram, its centre relative to the pixel's, tangent units.
struct Cell {
  float x_offset, y_offset, width, height;
  float slope;  ///< dy/dx of its upper and lower side
};

/// The echo of `cell` of the pixel at tangents (x, y): two independent even spreads, along its two sides.
EchoPatch patch_of(const SurfaceSample& sample, float x, float y, const Cell& cell, float weight) {
  RangePlane plane{sample.range_m, sample.range_dx, sample.range_dy};
  if (cell.x_offset != 0 || cell.y_offset != 0) {
    plane.move(x, y, cell.x_offset, cell.y_offset);
  }
  const float across = std::abs(plane.dx + cell.slope * plane.dy) * cell.width;
  const float along = std::abs(plane.dy) * cell.height;
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

}  // namespace

std::uint64_t make_grid_patches(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                                const ColumnPart& part, std::vector<EchoPatch>& patches) {
  const SubView& view = grid.views[static_cast<std::size_t>(part.view)];
  const SurfaceSample* column = views[static_cast<std::size_t>(part.view)] + part.column;
  const float* weights = &grid.weights[part.weights];
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

}  // namespace sonard::render
