// SPDX-License-Identifier: Apache-2.0
#include "renderer/binning/direction_echoes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "renderer/simd.hpp"

namespace sonard::render {
namespace {

constexpr double points_per_row = 4;
constexpr double points_per_bin = 2;
constexpr double most_points_of_a_patch = 8192;
constexpr std::size_t pattern_steps = 256;

/// A part of a patch.
struct Point {
  float row;     ///< of the grid, with a fraction
  float bin;     ///< range bin, with a fraction
  float energy;  ///< steradians, with the loss
};

/// Gaussian power pattern. @param offset from its axis, re its -3 dB full width
double pattern(double offset) {
  return std::exp2(-4 * offset * offset);
}

/// pattern() by the distance from the axis, up to direction_reach_beamwidths.
std::array<float, pattern_steps + 1> pattern_table() {
  std::array<float, pattern_steps + 1> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] =
        static_cast<float>(pattern(direction_reach_beamwidths * static_cast<double>(i) / pattern_steps));
  }
  return table;
}

class PointMaker {
 public:
  PointMaker(const DirectionGrid& grid, const RangeBins& range, const std::vector<float>& loss_of_bin)
      : grid_(grid), range_(range), loss_of_bin_(loss_of_bin) {}

  /// Divides a patch along its elevations. It is straight in the half plane of its azimuth, so the inverse of
  /// its horizontal distance is linear in the tangent of the elevation.
  void add(const EchoPatch& patch, std::vector<Point>& points) const {
    const double t_a = static_cast<double>(patch.tangent_a), t_b = static_cast<double>(patch.tangent_b);
    const double r_a = static_cast<double>(patch.range_a_m), r_b = static_cast<double>(patch.range_b_m);
    const double smear_a = static_cast<double>(patch.smear_a_m),
                 smear_b = static_cast<double>(patch.smear_b_m);
    const double echo = static_cast<double>(patch.echo);
    if (!(std::isfinite(t_a + t_b + r_a + r_b + smear_a + smear_b + echo) && r_a > 0 && r_b > 0 &&
          echo > 0)) {
      return;
    }
    const double inverse_a = std::sqrt(1 + t_a * t_a) / r_a, inverse_b = std::sqrt(1 + t_b * t_b) / r_b;
    const double rows = std::abs(std::atan(t_b) - std::atan(t_a)) / grid_.row_step_rad();
    const double bins = std::abs(r_b - r_a) / range_.step_m;
    const double count = std::ceil(
        std::clamp(std::max(rows * points_per_row, bins * points_per_bin), 1.0, most_points_of_a_patch));
    const double sine_a = sine_of(t_a), all = sine_of(t_b) - sine_a;
    double sine = sine_a, across = 0;  // across the wedge, in [-1/2, 1/2)
    for (double i = 0; i < count; ++i) {
      const double end = (i + 1) / count, middle = (i + 0.5) / count;
      const double next = sine_of(t_a + (t_b - t_a) * end);
      const double share = all == 0 ? 1 / count : (next - sine) / all;
      sine = next;
      const double t = t_a + (t_b - t_a) * middle;
      const double smear_m = smear_a + (smear_b - smear_a) * middle;
      const double range_m =
          std::sqrt(1 + t * t) / (inverse_a + (inverse_b - inverse_a) * middle) + smear_m * across;
      across += across + golden < 0.5 ? golden : golden - 1;
      const double bin = range_m / range_.step_m;
      if (range_m >= grid_.nearest_m && bin < static_cast<double>(range_.count)) {
        const double loss = static_cast<double>(loss_of_bin_[static_cast<std::size_t>(bin)]);
        points.push_back({static_cast<float>((std::atan(t) - grid_.elevation_rad(0)) / grid_.row_step_rad()),
                          static_cast<float>(bin), static_cast<float>(echo * share * loss)});
      }
    }
  }

 private:
  /// From a point to the next across the wedge. Multiples of it, without whole wedges, are evenly
  /// distributed.
  static constexpr double golden = 0.6180339887498949;

  static double sine_of(double tangent) { return tangent / std::sqrt(1 + tangent * tangent); }

  const DirectionGrid& grid_;
  const RangeBins& range_;
  const std::vector<float>& loss_of_bin_;
};

/// to[i] += weight * from[i]
SONARD_SIMD_CLONES
void add_weighted(const float* __restrict from, float weight, std::size_t count, float* __restrict to) {
  for (std::size_t i = 0; i < count; ++i) {
    to[i] += weight * from[i];
  }
}

/// The bins of a row that something was added to.
struct Touched {
  std::uint32_t low = std::numeric_limits<std::uint32_t>::max(), high = 0;

  std::size_t count() const { return low > high ? 0 : high - low + 1; }
};

/// Energy over range of the rows of a wedge. Two numbers per bin: energy, and its moment about the near end
/// of the bin, in bins.
struct WedgeSums {
  std::vector<Touched> rows;
  std::vector<float> sums;  ///< of the touched bins, row by row
};

/// Energy over range of the rows of a wedge or a column. One per thread.
class RowSums {
 public:
  void reset(int rows, int bins) {
    const std::size_t of_row = 2 * (static_cast<std::size_t>(bins) + 1);  // one bin more, which stays empty
    if (touched_.size() != static_cast<std::size_t>(rows) || of_row_ != of_row) {
      of_row_ = 0;  // if there is no memory
      sums_.assign(static_cast<std::size_t>(rows) * of_row, 0.0F);
      of_row_ = of_row;
    } else {
      for (std::size_t r = 0; r < touched_.size(); ++r) {
        std::fill_n(first_of(r), 2 * touched_[r].count(), 0.0F);
      }
    }
    touched_.assign(static_cast<std::size_t>(rows), {});
  }

  /// @param reach_rows half the rows that see a point
  void add(std::span<const Point> points, float reach_rows,
           const std::array<float, pattern_steps + 1>& table) {
    const float steps_per_row = static_cast<float>(pattern_steps) / reach_rows;
    const auto last_row = static_cast<float>(touched_.size()) - 1;
    for (const Point& point : points) {
      const float low = std::max(0.0F, std::ceil(point.row - reach_rows));
      const float high = std::min(last_row, std::floor(point.row + reach_rows));
      const auto bin = static_cast<std::uint32_t>(point.bin);
      const float within = point.bin - static_cast<float>(bin);
      for (float row = low; row <= high; ++row) {
        const auto step = static_cast<std::size_t>(std::abs(row - point.row) * steps_per_row);
        const float energy = point.energy * table[step];
        const auto r = static_cast<std::size_t>(row);
        float* const sum = &sums_[r * of_row_ + std::size_t{2} * bin];
        sum[0] += energy;
        sum[1] += energy * within;
        touched_[r].low = std::min(touched_[r].low, bin);
        touched_[r].high = std::max(touched_[r].high, bin);
      }
    }
  }

  void add(const WedgeSums& wedge, float weight) {
    const float* from = wedge.sums.data();
    for (std::size_t r = 0; r < wedge.rows.size(); ++r) {
      const Touched& row = wedge.rows[r];
      const std::size_t numbers = 2 * row.count();
      if (numbers > 0) {
        add_weighted(from, weight, numbers, &sums_[r * of_row_ + std::size_t{2} * row.low]);
        from += numbers;
        touched_[r].low = std::min(touched_[r].low, row.low);
        touched_[r].high = std::max(touched_[r].high, row.high);
      }
    }
  }

  WedgeSums of_wedge() {
    WedgeSums wedge{touched_, {}};
    for (std::size_t r = 0; r < touched_.size(); ++r) {
      wedge.sums.insert(wedge.sums.end(), first_of(r), first_of(r) + 2 * touched_[r].count());
    }
    return wedge;
  }

  struct Strongest {
    double bin = 0.0;  ///< mean, with a fraction
    float energy = 0.0F;
  };
  Strongest strongest(std::size_t row) const {
    const float* const sums = &sums_[row * of_row_];
    const auto energy_at = [sums](std::size_t k) { return sums[2 * k] + sums[2 * k + 2]; };
    const std::size_t low = touched_[row].low, high = touched_[row].high;
    std::size_t peak = low;
    for (std::size_t k = low; k <= high; ++k) {
      peak = energy_at(k) > energy_at(peak) ? k : peak;
    }
    if (low > high || !(energy_at(peak) > 0)) {
      return {};
    }
    const float half = energy_at(peak) / 2;
    std::size_t first = peak, last = peak;
    while (first > low && energy_at(first - 1) >= half) {
      --first;
    }
    while (last < high && energy_at(last + 1) >= half) {
      ++last;
    }
    double energy = 0.0, moment = 0.0;
    for (std::size_t k = first; k <= last + 1; ++k) {
      const auto here = static_cast<double>(sums[2 * k]);
      energy += here;
      moment += here * static_cast<double>(k - first) + static_cast<double>(sums[2 * k + 1]);
    }
    return {static_cast<double>(first) + moment / energy, energy_at(peak)};
  }

 private:
  /// The first touched bin of a row, or the first bin.
  float* first_of(std::size_t row) {
    return &sums_[row * of_row_ + (touched_[row].count() > 0 ? std::size_t{2} * touched_[row].low : 0)];
  }

  std::size_t of_row_ = 0;   ///< numbers of a row
  std::vector<float> sums_;  ///< [row][bin][energy, moment]
  std::vector<Touched> touched_;
};

}  // namespace

DirectionEchoes find_directions(const SeenPatches& seen, const DirectionGrid& grid, const RangeBins& range,
                                const std::vector<float>& loss_of_bin, WorkerPool& workers) {
  static const auto table = pattern_table();
  const auto reach_rows =
      static_cast<float>(direction_reach_beamwidths * grid.elevation_beamwidth_rad / grid.row_step_rad());
  const double reach_rad = direction_reach_beamwidths * grid.azimuth_beamwidth_rad;
  const PointMaker maker(grid, range, loss_of_bin);
  std::vector<WedgeSums> sums_of_wedge(seen.wedges.size());
  workers.run(static_cast<int>(seen.wedges.size()), [&](int wedge) {
    thread_local std::vector<Point> points;
    thread_local RowSums sums;
    const auto w = static_cast<std::size_t>(wedge);
    points.clear();
    for (const EchoPatch& patch : seen.of(w)) {
      maker.add(patch, points);
    }
    sums.reset(grid.rows, range.count);
    sums.add(points, reach_rows, table);
    sums_of_wedge[w] = sums.of_wedge();
  });
  DirectionEchoes echoes{grid.columns, grid.rows, {}, {}};
  const auto columns = static_cast<std::size_t>(grid.columns), rows = static_cast<std::size_t>(grid.rows);
  echoes.range_m.assign(columns * rows, 0.0F);
  echoes.intensity.assign(columns * rows, 0.0F);
  workers.run(grid.columns, [&](int column) {
    thread_local RowSums sums;
    sums.reset(grid.rows, range.count);
    const double azimuth_rad = grid.azimuth_rad(column);
    const auto first = std::ranges::partition_point(seen.wedges, [&](const SeenPatches::Wedge& wedge) {
      return wedge.azimuth_rad > azimuth_rad + reach_rad;
    });
    for (auto w = static_cast<std::size_t>(first - seen.wedges.begin());
         w < seen.wedges.size() && seen.wedges[w].azimuth_rad >= azimuth_rad - reach_rad; ++w) {
      const double offset = (seen.wedges[w].azimuth_rad - azimuth_rad) / grid.azimuth_beamwidth_rad;
      sums.add(sums_of_wedge[w], static_cast<float>(pattern(offset)));
    }
    for (std::size_t row = 0; row < rows; ++row) {
      const auto [bin, energy] = sums.strongest(row);
      const std::size_t pixel = row * columns + static_cast<std::size_t>(column);
      echoes.range_m[pixel] = static_cast<float>(bin * range.step_m);
      echoes.intensity[pixel] = energy;
    }
  });
  return echoes;
}

}  // namespace sonard::render
