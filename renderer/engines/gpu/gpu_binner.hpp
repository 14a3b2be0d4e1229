// SPDX-License-Identifier: Apache-2.0
// Binning on the GPU that drew the samples. Only the image and a few numbers per beam are read back.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/engines/gpu/beam_estimate.hpp"
#include "renderer/engines/gpu/raster_sampler.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

struct GpuGrid;

/// Makes an image by adding grids, each with some of its beams. One grid is binned like in bin_echoes(): the
/// same cells, cut at the same edges, and the same trapezoids. Sums are whole numbers, so the same samples
/// make the same bits on one OpenGL. Compared with bin_echoes(), which uses doubles, bins differ by rounding
/// (docs/accuracy.md). Only the thread of the sampler may use it.
class GpuBinner {
 public:
  /// @param sampler draws the samples; must outlive this object
  /// @param other binner of the same sampler whose shaders are shared; null: builds its own
  /// @throws RendererError if a shader does not build
  explicit GpuBinner(RasterSampler& sampler, const GpuBinner* other = nullptr);
  ~GpuBinner();
  GpuBinner(const GpuBinner&) = delete;
  GpuBinner& operator=(const GpuBinner&) = delete;

  /// Number of beams on one page of the current image, limited by the size of a buffer. The first page has
  /// the beams [0, beams_per_page()). All beams of a grid must be on one page.
  int beams_per_page() const;

  /// Loads a grid into GPU memory.
  /// @param beams beam of the image for each beam of the grid
  /// @param thinned the grid of every second column and row, from which add() estimates errors; null: no
  /// estimates
  /// @return must be destroyed before this object
  std::shared_ptr<const GpuGrid> load(const SampleGrid& grid, const std::vector<int>& beams,
                                      const SampleGrid* thinned = nullptr);

  struct ImageRequest {
    int beams = 0;
    const RangeLines& range;
    const BinningOptions& options;
    /// Factor of each line after binning, used as the weight of errors in estimates; empty: 1.
    const std::vector<float>& line_weight;
    /// The error of a beam at which BeamEstimate::zone_miss is 1.
    BeamError most_error{1.0, 1.0};
    /// In views with at least this many rows, two samples, one above the other, are binned as one if they lie
    /// on one plane (SkipRule::coplanar_samples); only with footprints. 0: never.
    int paired_rows = 0;
  };
  /// Begins an image. All objects that the request refers to must outlive the last add().
  /// @throws RequestError if OpenGL has too little memory for it
  void begin(const ImageRequest& request);

  /// Puts the beams of a grid into the image and replaces earlier ones.
  /// @param samples result of RasterSampler::draw() for the grid, or for a grid with the same views
  /// @throws RequestError if the beams do not fit in the buffers of this OpenGL
  void add(const GpuGrid& grid, unsigned samples);

  /// Requests the estimates of all beams added since the last call.
  void ask_estimates();
  /// The requested estimates, in the order of add(). Waits for them, but not for later work of the GPU.
  /// @throws RendererError if OpenGL fails
  std::vector<BeamEstimate> take_estimates();

  /// Requests the image.
  void ask_image();
  /// The requested image. Waits for it, but not for later work of the GPU.
  /// @param memory see bin_beams()
  /// @throws RendererError if OpenGL fails
  BinningResult take_image(std::vector<float> memory = {});

  /// Counts for the current image.
  struct Traffic {
    std::uint64_t bytes_read = 0;
    std::uint64_t synchronisations = 0;  ///< number of waits for the GPU
    std::uint64_t bytes_uploaded = 0;    ///< written into buffers
    /// Additions to words of the sums by invocations; valid after take_image(), modulo 2^32 per page.
    std::uint64_t atomic_additions = 0;
  };
  const Traffic& traffic() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
