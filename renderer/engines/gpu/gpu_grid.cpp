// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "renderer/engines/gpu/grid_choice.hpp"

namespace sonard::render {

namespace {

// The shaders use the same layouts.
struct GpuPart {
  std::int32_t column, row_begin, row_end, beam;
  float x, x_offset, width, limit_slope;
  float first_y_offset, first_height, last_y_offset, last_height;
  std::int32_t before, after;
  float to_before, to_after, width_rad;
  std::int32_t view;
  float unused[2] = {};
};
static_assert(sizeof(GpuPart) == 5 * 4 * 4, "is read as texels of four words");

struct GpuBeam {
  std::int32_t in_image;
  float solid_angle;
  std::int32_t part_begin, part_end;
  std::int32_t segment_begin, segment_end;
  std::int32_t rows;  // for error estimates; 0 if the beam has finest_rows()
};
static_assert(sizeof(GpuBeam) == 7 * 4, "must match std430");
struct GpuView {
  std::int32_t x, y, layer, rows;
  float left, bottom, pixel_width, pixel_height;
};
static_assert(sizeof(GpuView) == 2 * 4 * 4, "is read as texels of four words");
struct GpuSegment {
  std::int32_t view, column_begin, column_end;
  float x_begin, x_end;
  float unused[3] = {};
};
static_assert(sizeof(GpuSegment) == 2 * 4 * 4, "is read as texels of four words");

/// The part of the next column to port (-1) or starboard (1), even in another beam; the part itself if there
/// is no next column.
std::size_t neighbour(const SampleGrid& grid, std::size_t part, int to) {
  const ColumnPart& here = grid.parts[part];
  const double pixel_width = grid.views[static_cast<std::size_t>(here.view)].pixel_width();
  for (std::size_t p = part + static_cast<std::size_t>(to); p < grid.parts.size();
       p += static_cast<std::size_t>(to)) {
    const ColumnPart& there = grid.parts[p];
    if (there.view == here.view && there.column == here.column) {
      continue;  // the same column, cut by the edge of a beam
    }
    const double gap = to < 0 ? grid.starboard_rad(there) - grid.port_rad(here)
                              : grid.starboard_rad(here) - grid.port_rad(there);
    // Parts that were skipped are at most one column wide.
    return std::abs(gap) < 1.5 * pixel_width ? p : part;
  }
  return part;
}

std::vector<GpuPart> gpu_parts(const SampleGrid& grid) {
  std::vector<GpuPart> parts;
  parts.reserve(grid.parts.size());
  for (int beam = 0; beam < grid.beam_count(); ++beam) {
    const auto b = static_cast<std::size_t>(beam);
    for (int p = grid.beam_parts[b]; p < grid.beam_parts[b + 1]; ++p) {
      const auto index = static_cast<std::size_t>(p);
      const ColumnPart& part = grid.parts[index];
      const SubView& view = grid.views[static_cast<std::size_t>(part.view)];
      const std::size_t before = neighbour(grid, index, -1), after = neighbour(grid, index, 1);
      const auto distance = [&](std::size_t to) {
        return static_cast<float>(std::abs(grid.column_rad(part) - grid.column_rad(grid.parts[to])));
      };
      parts.push_back({part.column, part.row_begin, part.row_end, beam,
                       static_cast<float>(-view.tan_half_width + (part.column + 0.5) * view.pixel_width()),
                       part.x_offset, part.width, part.limit_slope, part.first_y_offset, part.first_height,
                       part.last_y_offset, part.last_height, static_cast<std::int32_t>(before),
                       static_cast<std::int32_t>(after), distance(before), distance(after),
                       static_cast<float>(grid.port_rad(part) - grid.starboard_rad(part)), part.view});
    }
  }
  return parts;
}

std::vector<GpuView> gpu_views(const SampleGrid& grid, const ViewLayout& layout) {
  std::vector<GpuView> views;
  for (std::size_t v = 0; v < grid.views.size(); ++v) {
    const SubView& view = grid.views[v];
    const ViewLayout::Place& place = layout.places[v];
    views.push_back({place.x, place.y, place.layer, view.rows,
                     static_cast<float>(-view.tan_half_width + 0.5 * view.pixel_width()),
                     static_cast<float>(-view.tan_half_height + 0.5 * view.pixel_height()),
                     static_cast<float>(view.pixel_width()), static_cast<float>(view.pixel_height())});
  }
  return views;
}

struct Segments {
  std::vector<GpuSegment> all;
  std::vector<int> begin{0};  ///< segments of beam b: [begin[b], begin[b + 1])
};

Segments segments_of(const SampleGrid& grid) {
  Segments segments;
  for (int beam = 0; beam < grid.beam_count(); ++beam) {
    const int end = grid.beam_parts[static_cast<std::size_t>(beam) + 1];
    for (int p = grid.beam_parts[static_cast<std::size_t>(beam)]; p < end;) {
      const int view = grid.parts[static_cast<std::size_t>(p)].view;
      int last = p;
      while (last < end && grid.parts[static_cast<std::size_t>(last)].view == view) {
        ++last;
      }
      const ColumnPart& port = grid.parts[static_cast<std::size_t>(p)];
      const ColumnPart& starboard = grid.parts[static_cast<std::size_t>(last - 1)];
      segments.all.push_back(
          {view, port.column, starboard.column + 1,
           static_cast<float>(grid.middle(port) - static_cast<double>(port.width) / 2),
           static_cast<float>(grid.middle(starboard) + static_cast<double>(starboard.width) / 2)});
      p = last;
    }
    segments.begin.push_back(static_cast<int>(segments.all.size()));
  }
  return segments;
}

}  // namespace

GpuColumns::GpuColumns(osg::GLExtensions& gl, const SampleGrid& grid, const ViewLayout& layout)
    : parts(gl),
      views(gl),
      part_count(grid.parts.size()),
      most_view_rows(std::ranges::max_element(grid.views, {}, &SubView::rows)->rows) {
  parts.fill(gpu_parts(grid));
  views.fill(gpu_views(grid, layout));
}

GpuGrid::GpuGrid(osg::GLExtensions& gl, const SampleGrid& grid, const std::vector<int>& in_image,
                 const SampleGrid* thinned_grid, int most_view_px)
    : GpuGrid(gl, grid, in_image, thinned_grid, lay_out(grid.views, most_view_px)) {}

GpuGrid::GpuGrid(osg::GLExtensions& gl, const SampleGrid& grid, const std::vector<int>& in_image,
                 const SampleGrid* thinned_grid, const ViewLayout& layout)
    : columns(gl, grid, layout),
      beams(gl),
      segments(gl),
      first_beam(in_image.front()),
      beam_count(static_cast<std::size_t>(grid.beam_count())),
      elevation(grid.aperture.elevation),
      pattern_scale(
          static_cast<float>(std::numbers::pi * 0.443 / std::sin(grid.aperture.vertical_beamwidth_rad / 2))),
      tan_limit(static_cast<float>(std::tan(grid.aperture.elevation_limit_rad()))) {
  const Segments found = segments_of(grid);
  if (thinned_grid != nullptr) {
    thinned = std::make_unique<GpuColumns>(gl, *thinned_grid, layout);
    segments.fill(found.all);
  }
  load_beams(grid, in_image, found.begin);
}

std::size_t GpuGrid::bytes() const {
  return columns.bytes() + (thinned ? thinned->bytes() : 0) + beams.bytes() + segments.bytes();
}

void GpuGrid::load_beams(const SampleGrid& grid, const std::vector<int>& in_image,
                         const std::vector<int>& segment_begin) {
  const Aperture& aperture = grid.aperture;
  const double height = aperture.pattern_height();
  const int finest = finest_rows(aperture);
  std::vector<GpuBeam> all;
  for (std::size_t b = 0; b < beam_count; ++b) {
    const auto beam = static_cast<std::size_t>(in_image[b]);
    const double solid_angle = height * (aperture.beam_edges_rad[beam] - aperture.beam_edges_rad[beam + 1]);
    int rows = 0, samples = 0;
    for (int p = grid.beam_parts[b]; p < grid.beam_parts[b + 1]; ++p) {
      const ColumnPart& part = grid.parts[static_cast<std::size_t>(p)];
      rows = std::max(rows, grid.views[static_cast<std::size_t>(part.view)].rows);
      samples += part.row_end - part.row_begin;
    }
    rows = rows < finest ? rows : 0;
    all.push_back({in_image[b], static_cast<float>(solid_angle), grid.beam_parts[b], grid.beam_parts[b + 1],
                   segment_begin[b], segment_begin[b + 1], rows});
    estimated_rows = std::max(estimated_rows, rows);
    most_samples = std::max(most_samples, samples);
    fullest_beam_sr = std::max(fullest_beam_sr, solid_angle);
  }
  beams.fill(all);
}

}  // namespace sonard::render
