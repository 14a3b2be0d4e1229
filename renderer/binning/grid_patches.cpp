#include "renderer/binning/grid_patches.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::render {

namespace {

/// What of a pixel counts: a parallelogram, its centre relative to the pixel's, tangent units.
struct Cell {
  float x_offset, y_offset, width, height;
  float slope;  ///< dy/dx of its upper and lower side
};

/// Range and its derivatives by the tangents.
struct RangePlane {
  float range, dx, dy;
};

/// From the centre of the pixel at (x, y) to that of the cell. On a plane the inverse depth is affine in x
/// and y, so the range at the cell's centre follows exactly from the pixel's range and its derivatives.
void move_to_cell(const Cell& cell, float x, float y, RangePlane& plane) {
  const float qq = 1 + x * x + y * y;
  // Relative slopes of the inverse depth, from equation (2) of docs/physics.md 2.3.
  const float slope_x = x / qq - plane.dx / plane.range;
  const float slope_y = y / qq - plane.dy / plane.range;
  const float inverse_depth = 1 + slope_x * cell.x_offset + slope_y * cell.y_offset;
  if (inverse_depth < 0.5F) {
    return;  // the plane turns away within the pixel: keep the pixel's own values
  }
  const float cx = x + cell.x_offset;
  const float cy = y + cell.y_offset;
  const float cell_qq = 1 + cx * cx + cy * cy;
  plane.range *= std::sqrt(cell_qq / qq) / inverse_depth;
  plane.dx = plane.range * (cx / cell_qq - slope_x / inverse_depth);
  plane.dy = plane.range * (cy / cell_qq - slope_y / inverse_depth);
}

/// The echo of `cell` of the pixel at tangents (x, y): two independent even spreads, along its two sides.
EchoPatch patch_of(const SurfaceSample& sample, float x, float y, const Cell& cell, float weight) {
  RangePlane plane{sample.range_m, sample.range_dx, sample.range_dy};
  if (cell.x_offset != 0 || cell.y_offset != 0) {
    move_to_cell(cell, x, y, plane);
  }
  const float across = std::abs(plane.dx + cell.slope * plane.dy) * cell.width;
  const float along = std::abs(plane.dy) * cell.height;
  const float spread = std::max(across, along);
  const float smear = std::min(across, along);
  return {plane.range - 0.5F * spread,
          plane.range + 0.5F * spread,
          smear,
          smear,
          weight * sample.response,
          weight};
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
