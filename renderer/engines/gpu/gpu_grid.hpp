// SPDX-License-Identifier: Apache-2.0
// A SampleGrid in GPU memory, in the layouts of binning_shader.hpp and estimate_shader.hpp.
#pragma once

#include <memory>
#include <vector>

#include <osg/GLExtensions>

#include "renderer/engines/gpu/gpu_buffer.hpp"
#include "renderer/engines/gpu/view_layout.hpp"
#include "renderer/sample_grid/sample_grid.hpp"

namespace sonard::render {

/// Column parts and views of a grid.
struct GpuColumns {
  GpuBuffer parts;  ///< in the order of the grid
  GpuBuffer views;
  std::size_t part_count;
  int most_view_rows;  ///< of any view

  /// @param layout of the drawn grid
  GpuColumns(osg::GLExtensions& gl, const SampleGrid& grid, const ViewLayout& layout);
  std::size_t bytes() const { return parts.bytes() + views.bytes(); }
};

/// Its context must be current when it is made, used and deleted.
struct GpuGrid {
  GpuColumns columns;
  std::unique_ptr<GpuColumns> thinned;  ///< every second column and row; null: errors are not estimated
  GpuBuffer beams;
  GpuBuffer segments;  ///< the columns of a beam in a view, beam by beam
  int first_beam;      ///< of the image
  std::size_t beam_count;
  int estimated_rows = 0;  ///< most rows of a beam with row estimates; 0: all beams have finest_rows()
  Aperture::Elevation elevation;
  float pattern_scale;  ///< the elevation pattern is a power of sinc(this * sine of the elevation)
  float tan_limit;      ///< of the elevations
  double fullest_beam_sr = 0.0;
  int most_samples = 1;  ///< of any beam

  /// @param in_image beam of the image for each beam of the grid
  /// @param most_view_px see lay_out()
  GpuGrid(osg::GLExtensions& gl, const SampleGrid& grid, const std::vector<int>& in_image,
          const SampleGrid* thinned_grid, int most_view_px);

  std::size_t bytes() const;  ///< of all buffers

 private:
  GpuGrid(osg::GLExtensions& gl, const SampleGrid& grid, const std::vector<int>& in_image,
          const SampleGrid* thinned_grid, const ViewLayout& layout);
  void load_beams(const SampleGrid& grid, const std::vector<int>& in_image,
                  const std::vector<int>& segment_begin);
};

}  // namespace sonard::render
