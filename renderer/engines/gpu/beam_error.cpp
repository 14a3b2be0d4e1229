// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/beam_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sonard::render {

namespace {

/// Echo, and its first moment over the range in lines.
struct Echo {
  double sum = 0.0;
  double moment = 0.0;

  void add(const Echo& other) {
    sum += other.sum;
    moment += other.moment;
  }
};

/// What a pixel adds to its beam.
struct PixelEcho {
  Echo echo;
  float share = 1.0F;  ///< of the pixel that counts
};

/// A column or a row of a beam.
struct Strip {
  Echo echo;
  double width = 0.0;   ///< any unit that all columns, or all rows, share
  double centre = 0.0;  ///< where it was sampled, in the same unit

  Echo density() const { return {echo.sum / width, echo.moment / width}; }
};

class EchoOfSample {
 public:
  EchoOfSample(const RangeLines& range, const std::vector<float>& line_weight)
      : lines_per_m_(static_cast<float>(1.0 / range.step_m)),
        lines_(static_cast<float>(range.count)),
        line_weight_(line_weight) {}

  /// @param width, height of the pixel, or of its part in the beam: tangent units.
  PixelEcho operator()(const SurfaceSample& sample, float width, float height, float solid_angle) const {
    const float line = sample.range_m * lines_per_m_;
    const float half =
        0.5F * lines_per_m_ * (std::abs(sample.range_dx) * width + std::abs(sample.range_dy) * height);
    // Where the last line cuts through a surface there is no edge: neither what lies beyond of a pixel nor
    // the next few pixels count.
    if (!(line > 0) || !(line - 9 * half < lines_)) {
      return {};
    }
    if (line - half >= lines_) {
      return {{}, 0.0F};
    }
    const bool cut = line + half > lines_;
    const float share = cut ? (lines_ - line + half) / (2 * half) : 1.0F;
    const float middle = cut ? (lines_ + line - half) / 2 : line;
    const float weight = line_weight_.empty() ? 1.0F : line_weight_[static_cast<std::size_t>(middle)];
    const float echo = sample.response * solid_angle * share * weight;
    if (!std::isfinite(echo)) {
      return {};
    }
    return {{static_cast<double>(echo), static_cast<double>(echo * middle)}, share};
  }

 private:
  float lines_per_m_, lines_;
  const std::vector<float>& line_weight_;
};

/// How the echo changes from strip to strip.
class Jumps {
 public:
  explicit Jumps(const Echo& all) : all_(all), centroid_(all.moment / all.sum) {}

  /// @param before, here, after three neighbours.
  /// @param width of the strip whose error is estimated from them, in their unit.
  /// @return what the strip may be off by: a lone jump is met twice, and the edge lies within half a strip of
  /// where it is taken to be.
  BeamError error(const Strip& before, const Strip& here, const Strip& after, double width) const {
    const double to_before = std::abs(here.centre - before.centre);
    const double to_after = std::abs(after.centre - here.centre);
    const double step = std::min(to_before, to_after);
    const Echo a = before.density(), b = here.density(), c = after.density();
    const auto bend = [&](double from, double at, double to) {
      return width * step * ((to - at) / to_after - (at - from) / to_before);
    };
    const double total = bend(a.sum, b.sum, c.sum);
    const double moment = bend(a.moment, b.moment, c.moment) - centroid_ * total;
    const double share = 1 / (std::sqrt(8.0) * all_.sum);
    return {std::abs(total) * share, std::abs(moment) * share};
  }

 private:
  Echo all_;
  double centroid_;
};

/// Adds an error that does not depend on those before.
void add(const BeamError& other, BeamError& error) {
  error.total = std::hypot(error.total, other.total);
  error.centroid_lines = std::hypot(error.centroid_lines, other.centroid_lines);
}

/// The strips of all columns, and the rows of each beam.
class Strips {
 public:
  explicit Strips(const SampleGrid& grid)
      : grid_(grid), columns_(grid.parts.size()), rows_(static_cast<std::size_t>(grid.beam_count())) {}

  void add_beam(std::size_t beam, const std::vector<const SurfaceSample*>& views,
                const EchoOfSample& echo_of) {
    for (std::size_t p = begin(beam); p < end(beam); ++p) {
      const ColumnPart& part = grid_.parts[p];
      const SubView& view = grid_.views[static_cast<std::size_t>(part.view)];
      const SurfaceSample* column = views[static_cast<std::size_t>(part.view)] + part.column;
      std::vector<Strip>& rows = rows_[beam];
      rows.resize(std::max(rows.size(), static_cast<std::size_t>(view.rows)));
      columns_[p].width = port_of(part) - starboard_of(part);
      columns_[p].centre = azimuth_of(part, 0.0, 0.0);
      for (int row = part.row_begin; row < part.row_end; ++row) {
        const float weight = grid_.weights[part.weights + static_cast<std::size_t>(row - part.row_begin)];
        const float height = height_of(part, row, view);
        const PixelEcho pixel =
            echo_of(column[static_cast<std::ptrdiff_t>(row) * view.columns], part.width, height, weight);
        columns_[p].echo.add(pixel.echo);
        rows[static_cast<std::size_t>(row)].echo.add(pixel.echo);
        rows[static_cast<std::size_t>(row)].width += static_cast<double>(part.width * height * pixel.share);
      }
    }
  }

  BeamErrorEstimate estimate(std::size_t beam) const {
    BeamErrorEstimate estimate;
    Echo all;
    for (std::size_t p = begin(beam); p < end(beam); ++p) {
      all.add(columns_[p].echo);
    }
    if (all.sum > 0) {
      estimate_columns(beam, all, estimate);
      estimate_rows(rows_[beam], all, estimate);
    }
    return estimate;
  }

 private:
  std::size_t begin(std::size_t beam) const { return static_cast<std::size_t>(grid_.beam_parts[beam]); }
  std::size_t end(std::size_t beam) const { return static_cast<std::size_t>(grid_.beam_parts[beam + 1]); }

  /// Height of the part of a pixel inside the fan, tangent units.
  static float height_of(const ColumnPart& part, int row, const SubView& view) {
    if (row == part.row_begin) {
      return part.first_height;
    }
    return row + 1 == part.row_end ? part.last_height : static_cast<float>(view.pixel_height());
  }

  /// Azimuth of the column's centre, moved by so much of the part's offset and width.
  double azimuth_of(const ColumnPart& part, double offset, double width) const {
    const SubView& view = grid_.views[static_cast<std::size_t>(part.view)];
    const double centre = -view.tan_half_width + (part.column + 0.5) * view.pixel_width();
    return view.azimuth_rad - std::atan(centre + offset * static_cast<double>(part.x_offset) +
                                        width * static_cast<double>(part.width));
  }
  double port_of(const ColumnPart& part) const { return azimuth_of(part, 1, -0.5); }
  double starboard_of(const ColumnPart& part) const { return azimuth_of(part, 1, 0.5); }

  void estimate_columns(std::size_t beam, const Echo& all, BeamErrorEstimate& estimate) const {
    const Jumps jumps(all);
    for (std::size_t p = begin(beam); p < end(beam); ++p) {
      // At the end of what was sampled, as from the column before it.
      const bool first = neighbour(p, -1) == p, last = neighbour(p, 1) == p;
      const std::size_t middle = first ? neighbour(p, 1) : last ? neighbour(p, -1) : p;
      const Strip& before = columns_[neighbour(middle, -1)];
      const Strip& here = columns_[middle];
      const Strip& after = columns_[neighbour(middle, 1)];
      const ColumnPart& part = grid_.parts[p];
      const BeamError error = jumps.error(before, here, after, columns_[p].width);
      estimate.columns.push_back({port_of(part), starboard_of(part), error});
      add(error, estimate.by_columns);
      const double beside = std::max(before.density().sum, after.density().sum);
      estimate.thin |= !first && !last && here.density().sum > 2 * beside;
    }
  }

  static void estimate_rows(const std::vector<Strip>& rows, const Echo& all, BeamErrorEstimate& estimate) {
    const Jumps jumps(all);
    for (std::size_t j = 1; j + 1 < rows.size(); ++j) {
      // Rows that the elevation limit or the last line leaves little of tell nothing.
      const double least = 0.1 * rows[j].width;
      if (rows[j - 1].width > least && rows[j].width > 0 && rows[j + 1].width > least) {
        const auto at = [&](std::size_t i) {
          Strip row = rows[i];
          row.centre = static_cast<double>(i) * rows[j].width;
          return row;
        };
        add(jumps.error(at(j - 1), at(j), at(j + 1), rows[j].width), estimate.by_rows);
      }
    }
  }

  /// The part of the next column to port (-1) or starboard (1), also where another beam begins; the part
  /// itself where there is none.
  std::size_t neighbour(std::size_t part, int to) const {
    const ColumnPart& here = grid_.parts[part];
    for (std::size_t p = part + static_cast<std::size_t>(to); p < grid_.parts.size();
         p += static_cast<std::size_t>(to)) {
      const ColumnPart& there = grid_.parts[p];
      if (there.view == here.view && there.column == here.column) {
        continue;  // the same column, cut by the edge of a beam
      }
      const double gap = to < 0 ? starboard_of(there) - port_of(here) : starboard_of(here) - port_of(there);
      // What was skipped is no wider than a column.
      return std::abs(gap) < 1.5 * grid_.views[static_cast<std::size_t>(here.view)].pixel_width() ? p : part;
    }
    return part;
  }

  const SampleGrid& grid_;
  std::vector<Strip> columns_;            ///< of each part of the grid
  std::vector<std::vector<Strip>> rows_;  ///< of each beam
};

}  // namespace

std::vector<BeamErrorEstimate> estimate_errors(const SampleGrid& grid,
                                               const std::vector<const SurfaceSample*>& views,
                                               const RangeLines& range, const std::vector<float>& line_weight,
                                               WorkerPool& workers) {
  const EchoOfSample echo_of(range, line_weight);
  Strips strips(grid);
  workers.run(grid.beam_count(),
              [&](int beam) { strips.add_beam(static_cast<std::size_t>(beam), views, echo_of); });
  std::vector<BeamErrorEstimate> estimate(static_cast<std::size_t>(grid.beam_count()));
  workers.run(grid.beam_count(), [&](int beam) {
    estimate[static_cast<std::size_t>(beam)] = strips.estimate(static_cast<std::size_t>(beam));
  });
  return estimate;
}

}  // namespace sonard::render
