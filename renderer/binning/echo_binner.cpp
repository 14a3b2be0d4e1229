#include "renderer/binning/echo_binner.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "renderer/binning/footprint.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

/// One beam's accumulators, in units of 1 / scale. What one sample gives to one line fits 31 bits, so it is
/// rounded and widened eight at a time; a line can take more than 2^32 of them.
struct BeamSums {
  std::vector<std::int64_t> echo;
  std::vector<std::int64_t> weight;  // only for means
  std::uint64_t samples = 0;
  std::uint64_t invalid = 0;

  BeamSums(std::size_t lines, bool mean) : echo(lines, 0), weight(mean ? lines : 0, 0) {}
};

/// A sample cut to one part of a pixel: what falls into the beam, in range lines.
struct Splat {
  float position;  ///< of the centre
  float a, b;      ///< spreads
  float echo, weight;
};

void add_point(const Splat& splat, double line_scale, BeamSums& sums) {
  const double line = std::floor(static_cast<double>(splat.position) * line_scale);
  if (line < 0 || line >= static_cast<double>(sums.echo.size())) {
    return;
  }
  const auto k = static_cast<std::size_t>(line);
  sums.echo[k] += static_cast<std::int32_t>(splat.echo);
  if (!sums.weight.empty()) {
    sums.weight[k] += static_cast<std::int32_t>(splat.weight);
  }
}

/// Adds `amount` spread over the lines [first, first + count), of which `below` holds the shares below each
/// edge.
inline void add_shares(const float* below, int count, float amount, std::int64_t* sums) {
  for (int i = 0; i < count; ++i) {
    sums[i] += static_cast<std::int32_t>(amount * (below[i + 1] - below[i]) + 0.5F);
  }
}

inline void add_footprint(const Splat& splat, BeamSums& sums) {
  const Footprint footprint = Footprint::make(splat.position, splat.a, splat.b);
  const auto lines = static_cast<float>(sums.echo.size());
  const float end = footprint.rise_from + footprint.base();
  if (!(end > 0) || !(footprint.rise_from < lines)) {
    return;
  }
  const auto first = static_cast<int>(std::max(0.0F, footprint.rise_from));
  const auto last = static_cast<int>(std::min(lines - 1, end));
  const int count = last - first + 1;
  std::array<float, static_cast<std::size_t>(2 * Footprint::widest) + 4> below;
  for (int i = 0; i <= count; ++i) {
    below[static_cast<std::size_t>(i)] = footprint.below(static_cast<float>(first + i));
  }
  add_shares(below.data(), count, splat.echo, &sums.echo[static_cast<std::size_t>(first)]);
  if (!sums.weight.empty()) {
    add_shares(below.data(), count, splat.weight, &sums.weight[static_cast<std::size_t>(first)]);
  }
}

class BeamBinner {
 public:
  BeamBinner(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views, const RangeLines& range,
             const BinningOptions& options, float scale)
      : grid_(grid),
        views_(views),
        options_(options),
        lines_per_m_(static_cast<float>(1.0 / range.step_m)),
        legacy_scale_(options.legacy_bin_index ? (range.count - 1.0) / range.count : 1.0),
        scale_(scale) {}

  SONARD_SIMD_CLONES void add_part(const ColumnPart& part, BeamSums& sums) const {
    const SubView& view = grid_.views[static_cast<std::size_t>(part.view)];
    const SurfaceSample* column = views_[static_cast<std::size_t>(part.view)] + part.column;
    const float* weights = &grid_.weights[part.weights];
    const auto x = static_cast<float>(-view.tan_half_width + (part.column + 0.5) * view.pixel_width());
    const auto bottom = static_cast<float>(-view.tan_half_height + 0.5 * view.pixel_height());
    const auto pixel_height = static_cast<float>(view.pixel_height());
    for (int row = part.row_begin; row < part.row_end; ++row) {
      const SurfaceSample& sample = column[static_cast<std::ptrdiff_t>(row) * view.columns];
      if (!(sample.range_m > 0)) {
        sums.invalid += sample.range_m < 0 ? 1 : 0;
        continue;
      }
      ++sums.samples;
      const float weight = weights[row - part.row_begin] * scale_;
      Splat splat{};
      splat.echo = weight * sample.response;
      splat.weight = weight;
      if (!options_.footprint) {
        splat.position = sample.range_m * lines_per_m_;
        add_point(splat, legacy_scale_, sums);
        continue;
      }
      Cell cell{part.x_offset, 0.0F, part.width, pixel_height, 0.0F};
      if (row == part.row_begin) {
        cell = {part.x_offset, part.first_y_offset, part.width, part.first_height, -part.limit_slope};
      } else if (row + 1 == part.row_end) {
        cell = {part.x_offset, part.last_y_offset, part.width, part.last_height, part.limit_slope};
      }
      place(sample, x, bottom + static_cast<float>(row) * pixel_height, cell, splat);
      add_footprint(splat, sums);
    }
  }

 private:
  /// What of a pixel counts: a parallelogram, its centre relative to the pixel's, tangent units.
  struct Cell {
    float x_offset, y_offset, width, height;
    float slope;  ///< dy/dx of its upper and lower side
  };

  /// Range and spread of the echo from `cell` of the pixel at tangents (x, y). On a plane the inverse depth
  /// is affine in x and y, so the range at the cell's centre follows exactly from the pixel's range and its
  /// derivatives.
  void place(const SurfaceSample& sample, float x, float y, const Cell& cell, Splat& splat) const {
    float range = sample.range_m;
    float range_dx = sample.range_dx;
    float range_dy = sample.range_dy;
    if (cell.x_offset != 0 || cell.y_offset != 0) {
      move_to_cell(cell, x, y, range, range_dx, range_dy);
    }
    splat.position = range * lines_per_m_;
    splat.a = std::abs(range_dx + cell.slope * range_dy) * cell.width * lines_per_m_;
    splat.b = std::abs(range_dy) * cell.height * lines_per_m_;
  }

  /// From the centre of the pixel at (x, y) to that of the cell.
  static void move_to_cell(const Cell& cell, float x, float y, float& range, float& range_dx,
                           float& range_dy) {
    const float qq = 1 + x * x + y * y;
    // Relative slopes of the inverse depth, from equation (2) of docs/physics.md 2.3.
    const float slope_x = x / qq - range_dx / range;
    const float slope_y = y / qq - range_dy / range;
    const float inverse_depth = 1 + slope_x * cell.x_offset + slope_y * cell.y_offset;
    if (inverse_depth < 0.5F) {
      return;  // the plane turns away within the pixel: keep the pixel's own values
    }
    const float cx = x + cell.x_offset;
    const float cy = y + cell.y_offset;
    const float cell_qq = 1 + cx * cx + cy * cy;
    range *= std::sqrt(cell_qq / qq) / inverse_depth;
    range_dx = range * (cx / cell_qq - slope_x / inverse_depth);
    range_dy = range * (cy / cell_qq - slope_y / inverse_depth);
  }

  const SampleGrid& grid_;
  const std::vector<const SurfaceSample*>& views_;
  const BinningOptions& options_;
  float lines_per_m_;
  double legacy_scale_;
  float scale_;
};

/// Power of two that maps the largest possible sample to below 2^30. Responses are at most 1: mu <= 1/pi,
/// sigmoid <= 1.
float fixed_point_scale(const SampleGrid& grid) {
  const float largest = *std::max_element(grid.weights.begin(), grid.weights.end());
  return std::exp2(std::floor(29 - std::log2(largest)));
}

}  // namespace

BinningResult bin_echoes(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                         const RangeLines& range, const BinningOptions& options, WorkerPool& workers) {
  BinningResult result;
  result.beams = grid.beam_count();
  result.lines = range.count;
  const auto lines = static_cast<std::size_t>(range.count);
  result.echo.resize(static_cast<std::size_t>(result.beams) * lines);
  const float scale = fixed_point_scale(grid);
  const BeamBinner binner(grid, views, range, options, scale);
  std::atomic<std::uint64_t> samples{0};
  std::atomic<std::uint64_t> invalid{0};
  workers.run(result.beams, [&](int beam) {
    BeamSums sums(lines, options.mean);
    const auto b = static_cast<std::size_t>(beam);
    for (int p = grid.beam_parts[b]; p < grid.beam_parts[b + 1]; ++p) {
      binner.add_part(grid.parts[static_cast<std::size_t>(p)], sums);
    }
    float* out = &result.echo[b * lines];
    for (std::size_t k = 0; k < lines; ++k) {
      const auto echo = static_cast<double>(sums.echo[k]);
      if (options.mean) {
        out[k] = sums.weight[k] > 0 ? static_cast<float>(echo / static_cast<double>(sums.weight[k])) : 0.0F;
      } else {
        out[k] = static_cast<float>(echo / static_cast<double>(scale));
      }
    }
    samples += sums.samples;
    invalid += sums.invalid;
  });
  result.samples = samples;
  result.invalid_samples = invalid;
  return result;
}

}  // namespace sonard::render
