// SPDX-License-Identifier: Apache-2.0
// Binning where the samples are: on the GPU that drew them. Read back are the image and a few numbers a beam.
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

/// An image in the making: grids are added to it, each of some of its beams. Of one grid it does what
/// bin_echoes() does: the same cells, cut at the same edges, the same trapezoids. Sums are whole numbers, so
/// on one OpenGL the same samples make the same bits; against bin_echoes(), which has doubles, bins differ by
/// roundings (docs/accuracy.md). The thread of the sampler uses it.
class GpuBinner {
 public:
  /// @param sampler draws the samples; outlives this object.
  /// @param other of the same sampler, whose shaders this one shares; null: it builds its own.
  /// @throws RendererError when a shader does not build.
  explicit GpuBinner(RasterSampler& sampler, const GpuBinner* other = nullptr);
  ~GpuBinner();
  GpuBinner(const GpuBinner&) = delete;
  GpuBinner& operator=(const GpuBinner&) = delete;

  /// How many beams of the image that was begun lie on one page of it: a buffer holds no more. The beams of
  /// a grid all lie on one page, of which the first is that of beams [0, beams_per_page()).
  int beams_per_page() const;

  /// @param beams of the image, in the order of those of the grid.
  /// @param thinned the grid of every second column and row: then add() estimates errors too. Null: it does
  /// not.
  /// @return to be given up before this object.
  std::shared_ptr<const GpuGrid> load(const SampleGrid& grid, const std::vector<int>& beams,
                                      const SampleGrid* thinned = nullptr);

  struct ImageRequest {
    int beams = 0;
    const RangeLines& range;
    const BinningOptions& options;
    /// What each line is yet to be multiplied with, which estimates weigh errors by; empty: 1.
    const std::vector<float>& line_weight;
    /// The error of a beam that counts as 1 in BeamEstimate::zone_miss.
    BeamError most_error{1.0, 1.0};
    /// In views of at least so many rows two samples, one above the other, are binned as one where they see
    /// one plane (SkipRule::coplanar_samples); with footprints. 0: in none.
    int paired_rows = 0;
  };
  /// Begins an image. All that the request refers to outlives its last add().
  /// @throws RequestError when this OpenGL has no memory for it.
  void begin(const ImageRequest& request);

  /// Puts the beams of a grid into the image, in place of what it has of them.
  /// @param samples what RasterSampler::draw() returned for the grid, or for one with the same views.
  /// @throws RequestError when the buffers of this OpenGL cannot hold what it takes.
  void add(const GpuGrid& grid, unsigned samples);

  /// Has the estimates of all beams that were added since the last call sent back.
  void ask_estimates();
  /// Those estimates, in the order of beams. Waits for them, but for nothing that the GPU was given since.
  /// @throws RendererError when OpenGL fails.
  std::vector<BeamEstimate> take_estimates();

  /// Has the image sent back.
  void ask_image();
  /// That image; waits for it in the same way.
  /// @param memory as of bin_echoes()
  /// @throws RendererError when OpenGL fails.
  BinningResult take_image(std::vector<float> memory = {});

  /// Of the image at hand.
  struct Traffic {
    std::uint64_t bytes_read = 0;
    std::uint64_t synchronisations = 0;  ///< how often something was waited for
    std::uint64_t bytes_uploaded = 0;    ///< written into buffers
    /// How often an invocation has added to a word of the sums: after take_image(), modulo 2^32 for each
    /// page.
    std::uint64_t atomic_additions = 0;
  };
  const Traffic& traffic() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
