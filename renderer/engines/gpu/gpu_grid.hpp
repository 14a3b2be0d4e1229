// SPDX-License-Identifier: Apache-2.0
// A SampleGrid in the memory of the GPU, in the layouts of binning_shader.hpp and estimate_shader.hpp.
#pragma once

#include <memory>
#include <vector>

#include <osg/GLExtensions>

#include "renderer/engines/gpu/gpu_buffer.hpp"
#include "renderer/sample_grid/sample_grid.hpp"

namespace sonard::render {

/// What lies where in the views of a grid.
struct GpuColumns {
  std::vector<SubView> views;
  GpuBuffer parts;              ///< in the order of the grid
  GpuBuffer order;              ///< their numbers, view by view
  std::vector<int> view_begin;  ///< in `order`: parts of view v are [view_begin[v], view_begin[v + 1])

  GpuColumns(osg::GLExtensions& gl, const SampleGrid& grid);
  std::size_t bytes() const { return parts.bytes() + order.bytes(); }
};

/// Made, used and deleted while its context is current.
struct GpuGrid {
  GpuColumns columns;
  std::unique_ptr<GpuColumns> thinned;  ///< of every second column and row; null: errors are not estimated
  GpuBuffer beams;
  GpuBuffer view_beams;               ///< beams with columns in a view, view by view
  std::vector<int> view_beams_begin;  ///< in `view_beams`, as above
  std::vector<bool> continues_beams;  ///< whether a view has columns of beams that views before it have, too
  int first_beam;                     ///< of the image
  std::size_t beam_count, part_count;
  int most_rows = 0;  ///< of any beam
  Aperture::Elevation elevation;
  float pattern_scale;  ///< the elevation pattern is a power of sinc(this * sine of the elevation)
  float tan_limit;      ///< of the elevations
  double fullest_beam_sr = 0.0;
  int most_samples = 1;  ///< of any beam

  /// @param in_image which beam of the image each beam of the grid is.
  GpuGrid(osg::GLExtensions& gl, const SampleGrid& grid, const std::vector<int>& in_image,
          const SampleGrid* thinned_grid);

  std::size_t bytes() const;  ///< of all buffers

 private:
  void load_beams(const SampleGrid& grid, const std::vector<int>& in_image);
};

}  // namespace sonard::render
