// SPDX-License-Identifier: Apache-2.0
// Binning where the samples are: on the GPU that drew them. Only the image is read back.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/engines/gpu/raster_sampler.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Does what bin_echoes() does for a grid, in compute shaders: the same cells, cut at the same edges, the
/// same trapezoids. Sums are whole numbers, so on one OpenGL the same samples make the same bits; against
/// bin_echoes(), which has doubles, bins differ by roundings (docs/accuracy.md). The thread of the sampler
/// uses it.
class GpuBinner {
 public:
  /// @param sampler draws the samples; outlives this object.
  /// @throws RendererError when a shader does not build.
  explicit GpuBinner(RasterSampler& sampler);
  ~GpuBinner();
  GpuBinner(const GpuBinner&) = delete;
  GpuBinner& operator=(const GpuBinner&) = delete;

  /// Hands the grid's columns and weights to the GPU, which keeps them until there is another grid.
  void set_grid(const SampleGrid& grid);

  /// Makes room for images of the grid's beams and so many lines.
  /// @return why it is not available, in one line: use bin_echoes() then. Empty: it is available.
  std::string make_room(int lines, const BinningOptions& options);

  /// @param textures what RasterSampler::draw() returned for the grid.
  /// @param range, options what make_room() has made room for.
  /// @param memory as of bin_echoes()
  /// @throws RendererError when OpenGL fails.
  BinningResult bin(const std::vector<unsigned>& textures, const RangeLines& range,
                    const BinningOptions& options, std::vector<float> memory = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
