// SPDX-License-Identifier: Apache-2.0
#include "tests/gl/gpu_binning/double_binning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonard::test {
namespace {

// Limits of footprints, as in renderer/binning/range_profile.
constexpr double least_width = 1e-3;  // lines
constexpr double most_smear = 512.0;

struct Footprint {
  double centre, wide, narrow;  ///< lines
};

/// Cumulative distribution of the sum of two uniform spreads about 0 (docs/physics.md 2.3).
/// @param wide, narrow their widths, `wide` >= `narrow`
double distribution(double x, double wide, double narrow) {
  const double h = (wide + narrow) / 2, c = (wide - narrow) / 2;
  if (std::abs(x) >= h) {
    return x < 0 ? 0 : 1;
  }
  if (std::abs(x) <= c) {
    return 0.5 + x / wide;
  }
  const double tail = (h - std::abs(x)) * (h - std::abs(x)) / (2 * wide * narrow);
  return x < 0 ? tail : 1 - tail;
}

/// Footprint of a cell of the pixel at tangents (x, y): a parallelogram whose centre is off by (dx, dy).
Footprint footprint(const render::SurfaceSample& sample, double x, double y, double dx, double dy,
                    double width, double height, double side_slope, double lines_per_m) {
  // The plane n.p = 1 of the sample: along the ray (x, y, 1) the inverse of the depth is n.q, and range =
  // depth |q|, so its gradient follows from the range's gradient.
  const double norm = std::sqrt(1 + x * x + y * y);
  const double inverse = norm / static_cast<double>(sample.range_m);
  const double gx = inverse * (x / (norm * norm) - static_cast<double>(sample.range_dx / sample.range_m));
  const double gy = inverse * (y / (norm * norm) - static_cast<double>(sample.range_dy / sample.range_m));
  double u = x + dx, v = y + dy;
  if (inverse + gx * dx + gy * dy < 0.5 * inverse) {
    u = x;  // the surface turns away within the pixel, so its centre is used
    v = y;
  }
  const double q = std::sqrt(1 + u * u + v * v);
  const double there = inverse + gx * (u - x) + gy * (v - y);
  const double range = q / there;
  const double range_u = range * (u / (q * q) - gx / there);
  const double range_v = range * (v / (q * q) - gy / there);
  const double a = std::abs(range_u + side_slope * range_v) * width * lines_per_m;
  const double b = std::abs(range_v) * height * lines_per_m;
  return {range * lines_per_m, std::max({a, b, least_width}),
          std::clamp(std::min(a, b), least_width, most_smear)};
}

class DoubleBinner {
 public:
  DoubleBinner(const render::SampleGrid& grid, const std::vector<const render::SurfaceSample*>& views,
               const render::RangeLines& range, const render::BinningOptions& options)
      : grid_(grid), views_(views), options_(options), lines_(static_cast<std::size_t>(range.count)) {
    const double scale = options.legacy_bin_index ? (range.count - 1.0) / range.count : 1.0;
    lines_per_m_ = scale / range.step_m;
    echo_.resize(static_cast<std::size_t>(grid.beam_count()) * lines_);
    weight_.resize(echo_.size());
  }

  std::vector<double> bin() {
    for (int beam = 0; beam < grid_.beam_count(); ++beam) {
      const auto b = static_cast<std::size_t>(beam);
      double solid_angle = 0;
      for (int p = grid_.beam_parts[b]; p < grid_.beam_parts[b + 1]; ++p) {
        const render::ColumnPart& part = grid_.parts[static_cast<std::size_t>(p)];
        for (int row = part.row_begin; row < part.row_end; ++row) {
          solid_angle += weight_of(part, row);
          add(b, part, row);
        }
      }
      if (options_.mean) {
        take_means(b, solid_angle);
      }
    }
    return echo_;
  }

 private:
  double weight_of(const render::ColumnPart& part, int row) const {
    return static_cast<double>(grid_.weight(part, row));
  }

  void add(std::size_t beam, const render::ColumnPart& part, int row) {
    const auto v = static_cast<std::size_t>(part.view);
    const render::SurfaceSample& sample = views_[v][row * grid_.views[v].columns + part.column];
    if (!(sample.range_m > 0)) {
      return;
    }
    const double weight = weight_of(part, row);
    const double echo = weight * static_cast<double>(sample.response);
    const auto add_to = [&](double line, double share) {
      if (line >= 0 && line < static_cast<double>(lines_)) {
        echo_[beam * lines_ + static_cast<std::size_t>(line)] += share * echo;
        weight_[beam * lines_ + static_cast<std::size_t>(line)] += share * weight;
      }
    };
    if (!options_.footprint) {
      add_to(std::floor(static_cast<double>(sample.range_m) * lines_per_m_), 1);
      return;
    }
    const Footprint f = footprint_of(sample, part, row);
    const double half = (f.wide + f.narrow) / 2;
    const double end = std::min(f.centre + half, static_cast<double>(lines_));
    for (double k = std::max(0.0, std::floor(f.centre - half)); k <= end; ++k) {
      add_to(k,
             distribution(k + 1 - f.centre, f.wide, f.narrow) - distribution(k - f.centre, f.wide, f.narrow));
    }
  }

  Footprint footprint_of(const render::SurfaceSample& sample, const render::ColumnPart& part, int row) const {
    const render::SubView& view = grid_.views[static_cast<std::size_t>(part.view)];
    double dy = 0, height = view.pixel_height(), slope = 0;
    if (row == part.row_begin) {
      dy = static_cast<double>(part.first_y_offset);
      height = static_cast<double>(part.first_height);
      slope = -static_cast<double>(part.limit_slope);
    } else if (row + 1 == part.row_end) {
      dy = static_cast<double>(part.last_y_offset);
      height = static_cast<double>(part.last_height);
      slope = static_cast<double>(part.limit_slope);
    }
    return footprint(sample, -view.tan_half_width + (part.column + 0.5) * view.pixel_width(),
                     -view.tan_half_height + (row + 0.5) * view.pixel_height(),
                     static_cast<double>(part.x_offset), dy, static_cast<double>(part.width), height, slope,
                     lines_per_m_);
  }

  /// As both binners: 0 if less than 2^-32 of the beam is seen.
  void take_means(std::size_t beam, double solid_angle) {
    for (std::size_t i = beam * lines_; i < (beam + 1) * lines_; ++i) {
      echo_[i] = weight_[i] > 0x1p-32 * solid_angle ? std::min(1.0, echo_[i] / weight_[i]) : 0.0;
    }
  }

  const render::SampleGrid& grid_;
  const std::vector<const render::SurfaceSample*>& views_;
  const render::BinningOptions options_;
  const std::size_t lines_;
  double lines_per_m_ = 1;
  std::vector<double> echo_, weight_;
};

}  // namespace

std::vector<double> bin_in_double(const render::SampleGrid& grid,
                                  const std::vector<const render::SurfaceSample*>& views,
                                  const render::RangeLines& range, const render::BinningOptions& options) {
  return DoubleBinner(grid, views, range, options).bin();
}

}  // namespace sonard::test
