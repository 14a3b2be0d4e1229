// SPDX-License-Identifier: Apache-2.0
#include "renderer/sample_grid/sample_grid.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <string>

#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

// In wider planar views the pixels are too unequal (docs/physics.md 1.3).
constexpr double widest_view_rad = std::numbers::pi / 3;
constexpr double widest_single_view_rad = 2.8;  // a planar view must be narrower than pi
constexpr double most_samples = 0x1p27;         // 2 GiB of samples

void check(const Sampling& sampling) {
  if (sampling.views < 1 || sampling.columns_per_view < 1 || sampling.rows < 1 || sampling.views > 64 ||
      sampling.columns_per_view > 16384 || sampling.rows > 16384) {
    throw RequestError("sampling: views, columns or rows out of range");
  }
}

/// Number of views of equal width that span the fan.
int view_count(const Aperture& aperture, const Sampling& sampling, const GridOptions& options) {
  check(sampling);
  const double width = aperture.beam_edges_rad.front() - aperture.beam_edges_rad.back();
  int count = sampling.views;
  if (options.elevation_mask) {
    count = std::max(count, static_cast<int>(std::ceil(width / widest_view_rad - 1e-9)));
  } else if (width / count > widest_single_view_rad) {
    throw RequestError("sampling: one planar view cannot span the fan; raise views");
  }
  const double samples = 1.0 * count * sampling.columns_per_view * sampling.rows;
  if (samples > most_samples) {
    throw RequestError("sampling: more than 2^27 samples; lower views, columns or rows");
  }
  return count;
}

SubView make_view(const Aperture& aperture, double port_rad, double starboard_rad, const Sampling& sampling,
                  const GridOptions& options) {
  const double half = (port_rad - starboard_rad) / 2;
  SubView view;
  view.azimuth_rad = (port_rad + starboard_rad) / 2;
  view.tan_half_width = std::tan(half);
  // In the plane of the view the elevation limit is highest at the sides. Without the mask the view is the
  // paper's frustum, whose limit holds on the axis only.
  view.tan_half_height =
      std::tan(aperture.elevation_limit_rad()) / (options.elevation_mask ? std::cos(half) : 1.0);
  view.columns = sampling.columns_per_view;
  view.rows = sampling.rows;
  return view;
}

/// Builds the parts of one aperture.
class GridBuilder {
 public:
  GridBuilder(const Aperture& aperture, const GridOptions& options, SampleGrid& grid)
      : options_(options), grid_(grid), tan_limit_(std::tan(aperture.elevation_limit_rad())) {
    grid_.aperture = aperture;
    grid_.beam_parts.push_back(0);
  }

  void add_views(const Sampling& sampling) {
    const int count = view_count(grid_.aperture, sampling, options_);
    const double port = grid_.aperture.beam_edges_rad.front();
    const double width = port - grid_.aperture.beam_edges_rad.back();
    for (int i = 0; i < count; ++i) {
      grid_.views.push_back(make_view(grid_.aperture, port - width * i / count,
                                      port - width * (i + 1) / count, sampling, options_));
    }
  }

  /// @throws RequestError if a beam gets no column
  void add_beams() {
    for (int beam = 0; beam < grid_.aperture.beam_count(); ++beam) {
      const auto b = static_cast<std::size_t>(beam);
      add_beam(grid_.aperture.beam_edges_rad[b], grid_.aperture.beam_edges_rad[b + 1]);
      if (grid_.beam_parts.back() == *std::prev(grid_.beam_parts.end(), 2)) {
        throw RequestError("sampling: beam " + std::to_string(beam) +
                           " gets no column; raise columns per view");
      }
    }
  }

 private:
  void add_beam(double port_edge_rad, double starboard_edge_rad) {
    for (std::size_t v = 0; v < grid_.views.size(); ++v) {
      const SubView& view = grid_.views[v];
      const double half = std::atan(view.tan_half_width);
      // Azimuth from the view axis, positive to starboard; edges outside the view are clamped to its side.
      const double from = std::clamp(view.azimuth_rad - port_edge_rad, -half, half);
      const double to = std::clamp(view.azimuth_rad - starboard_edge_rad, -half, half);
      if (to > from) {
        add_columns(static_cast<int>(v), std::tan(from), std::tan(to));
      }
    }
    grid_.beam_parts.push_back(static_cast<int>(grid_.parts.size()));
  }

  void add_columns(int view_index, double x_from, double x_to) {
    const SubView& view = grid_.views[static_cast<std::size_t>(view_index)];
    const double step = view.pixel_width();
    const auto column_of = [&](double x) { return (x + view.tan_half_width) / step; };
    const int first = std::clamp(static_cast<int>(std::floor(column_of(x_from))), 0, view.columns - 1);
    const int last = std::clamp(static_cast<int>(std::ceil(column_of(x_to))), 1, view.columns);
    for (int column = first; column < last; ++column) {
      const double left = -view.tan_half_width + column * step;
      double part_from = std::max(x_from, left);
      double part_to = std::min(x_to, left + step);
      if (options_.whole_columns) {
        const double centre = left + step / 2;
        if (centre < x_from || centre >= x_to) {
          continue;
        }
        part_from = left;
        part_to = left + step;
      }
      if (part_to - part_from > 1e-9 * step) {
        add_part(view_index, column, part_from, part_to);
      }
    }
  }

  void add_part(int view_index, int column, double x_from, double x_to) {
    const SubView& view = grid_.views[static_cast<std::size_t>(view_index)];
    const double x = (x_from + x_to) / 2;
    const double centre = -view.tan_half_width + (column + 0.5) * view.pixel_width();
    const double limit = options_.elevation_mask ? tan_limit_ * std::hypot(1.0, x) : view.tan_half_height;
    ColumnPart part;
    part.view = view_index;
    part.column = column;
    const bool whole = x_to - x_from > (1 - 1e-9) * view.pixel_width();
    part.x_offset = whole ? 0.0F : static_cast<float>(x - centre);
    part.width = static_cast<float>(x_to - x_from);
    if (options_.elevation_mask) {
      part.limit_slope = static_cast<float>(tan_limit_ * x / std::hypot(1.0, x));
    }
    add_rows(view, std::min(limit, view.tan_half_height), part);
    grid_.parts.push_back(part);
  }

  static void add_rows(const SubView& view, double limit, ColumnPart& part) {
    const double step = view.pixel_height();
    const auto row_of = [&](double y) { return (y + view.tan_half_height) / step; };
    part.row_begin = std::clamp(static_cast<int>(std::floor(row_of(-limit) + 1e-9)), 0, view.rows - 1);
    part.row_end =
        std::clamp(static_cast<int>(std::ceil(row_of(limit) - 1e-9)), part.row_begin + 1, view.rows);
    // The part of a row between the limits: its middle relative to the pixel's, and its height.
    const auto cut = [&](int row, float& offset, float& height) {
      const double bottom = -view.tan_half_height + row * step;
      const double from = std::max(bottom, -limit);
      const double to = std::min(bottom + step, limit);
      offset = static_cast<float>((from + to) / 2 - bottom - step / 2);
      height = static_cast<float>(std::max(0.0, to - from));
    };
    cut(part.row_begin, part.first_y_offset, part.first_height);
    cut(part.row_end - 1, part.last_y_offset, part.last_height);
  }

  const GridOptions& options_;
  SampleGrid& grid_;
  const double tan_limit_;
};

double azimuth_at(const SubView& view, double x) {
  return view.azimuth_rad - std::atan(x);
}

}  // namespace

double SampleGrid::middle(const ColumnPart& part) const {
  const SubView& view = views[static_cast<std::size_t>(part.view)];
  return -view.tan_half_width + (part.column + 0.5) * view.pixel_width() + static_cast<double>(part.x_offset);
}

double SampleGrid::port_rad(const ColumnPart& part) const {
  return azimuth_at(views[static_cast<std::size_t>(part.view)],
                    middle(part) - static_cast<double>(part.width) / 2);
}

double SampleGrid::starboard_rad(const ColumnPart& part) const {
  return azimuth_at(views[static_cast<std::size_t>(part.view)],
                    middle(part) + static_cast<double>(part.width) / 2);
}

float SampleGrid::weight(const ColumnPart& part, int row) const {
  const SubView& view = views[static_cast<std::size_t>(part.view)];
  const bool first = row == part.row_begin, last = row + 1 == part.row_end;
  const double height = first  ? static_cast<double>(part.first_height)
                        : last ? static_cast<double>(part.last_height)
                               : view.pixel_height();
  const double offset = static_cast<double>(first ? part.first_y_offset : last ? part.last_y_offset : 0.0F);
  const double x = middle(part);
  const double y = -view.tan_half_height + (row + 0.5) * view.pixel_height() + offset;
  const double q = 1 + x * x + y * y;
  const double pattern = aperture.elevation == Aperture::Elevation::top_hat
                             ? 1.0
                             : aperture.elevation_weight(std::atan(y / std::hypot(1.0, x)));
  return static_cast<float>(static_cast<double>(part.width) * height / (q * std::sqrt(q)) * pattern);
}

std::size_t SampleGrid::cell_count() const {
  std::size_t cells = 0;
  for (const ColumnPart& part : parts) {
    cells += static_cast<std::size_t>(part.row_end - part.row_begin);
  }
  return cells;
}

CellWeights::CellWeights(const SampleGrid& grid) {
  weights_.reserve(grid.cell_count());
  first_.push_back(0);
  for (const ColumnPart& part : grid.parts) {
    for (int row = part.row_begin; row < part.row_end; ++row) {
      weights_.push_back(grid.weight(part, row));
    }
    first_.push_back(weights_.size());
  }
}

double CellWeights::sum(std::size_t begin, std::size_t end) const {
  return std::accumulate(weights_.begin() + static_cast<std::ptrdiff_t>(first_[begin]),
                         weights_.begin() + static_cast<std::ptrdiff_t>(first_[end]), 0.0);
}

bool needs_grid(const SonarSettings& settings) {
  const PaperModel& paper = settings.paper;
  return settings.sampling.preset == Sampling::Preset::grid || !settings.sampling.footprint ||
         (settings.model == Model::paper &&
          (!paper.footprint || paper.legacy_bin_index || paper.legacy_columns || !paper.elevation_mask));
}

std::string missed_by_grid(const SonarSettings& settings) {
  const bool is_cone = settings.aperture.bearing == Aperture::Bearing::conical;
  if (!is_cone && !needs_grid(settings)) {
    return {};
  }
  return std::string("engine gpu may miss posts and bars thinner than a column in some pings, because `") +
         (is_cone ? "bearing: conical" : "sampling: {preset: grid}") + "` does not search for them";
}

GridOptions grid_options(const SonarSettings& settings) {
  GridOptions options;
  if (settings.model == Model::paper) {
    options.whole_columns = settings.paper.legacy_columns;
    options.elevation_mask = settings.paper.elevation_mask;
  }
  return options;
}

SampleGrid make_sample_grid(const Aperture& aperture, const Sampling& sampling, const GridOptions& options) {
  check_aperture(aperture);
  SampleGrid grid;
  GridBuilder builder(aperture, options, grid);
  builder.add_views(sampling);
  builder.add_beams();
  return grid;
}

}  // namespace sonard::render
