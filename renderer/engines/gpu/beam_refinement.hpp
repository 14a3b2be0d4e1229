// SPDX-License-Identifier: Apache-2.0
// Grids of samples with the density that each beam needs (docs/accuracy.md).
#pragma once

#include <list>
#include <memory>
#include <vector>

#include "renderer/engine.hpp"
#include "renderer/engines/gpu/gpu_binner.hpp"
#include "renderer/engines/gpu/grid_choice.hpp"
#include "renderer/engines/gpu/raster_sampler.hpp"
#include "renderer/engines/gpu/thin_things.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

/// Samples the whole fan with an even grid, lets the GPU estimate the error of every beam, and samples beams
/// again that may miss the preset's targets. All passes, and so the image, depend on the request alone. Only
/// one thread may use it.
class BeamRefinement {
 public:
  class Ping;
  /// Largest number of pings at the same time.
  static constexpr std::size_t most_pings = 8;

  /// @param sampler must outlive this object; its context must be current in the destructor
  /// @param thin_things must outlive this object
  BeamRefinement(RasterSampler& sampler, const ThinThings& thin_things)
      : sampler_(sampler), thin_things_(thin_things) {}

  /// Gives the first pass of a request to the GPU.
  /// @param binner has begun the image; it, the request and the statistics must outlive the result
  /// @param keep_grid the first pass may reuse an equal grid of an earlier ping; this counts as
  /// SkipRule::unchanged_settings
  /// @throws RequestError if the aperture or the sampling are out of range
  /// @throws RendererError see RasterSampler
  std::unique_ptr<Ping> begin(GpuBinner& binner, const EchoRequest& request, const SurfaceModel& surface,
                              bool keep_grid, PingStatistics& statistics);

 private:
  /// A grid of some beams, and its data on the GPU.
  struct Grid {
    std::shared_ptr<const SampleGrid> samples;
    std::shared_ptr<const GpuGrid> on_gpu;
  };
  /// The even grids of the first pass, one for each page of the image.
  struct EvenGrids {
    Aperture aperture;
    BeamDensity density;
    int beams_per_page;
    std::vector<Grid> grids;
  };

  static Grid make_grid(GpuBinner& binner, const Aperture& aperture, const std::vector<BeamRun>& runs,
                        bool with_estimate);
  const EvenGrids* known_even_grids(const EvenGrids& wanted);
  const EvenGrids& make_even_grids(GpuBinner& binner, EvenGrids wanted);

  RasterSampler& sampler_;
  const ThinThings& thin_things_;
  std::list<EvenGrids> even_;  ///< last used first; heads that share a renderer alternate
};

/// A ping in progress. Its image can be requested when advance() returns false.
class BeamRefinement::Ping {
 public:
  Ping(RasterSampler& sampler, const ThinThings& thin_things, GpuBinner& binner, const EchoRequest& request,
       const SurfaceModel& surface, PingStatistics& statistics);

  /// Waits for the estimates of the last pass and gives the next pass to the GPU.
  /// @return true if more estimates will follow
  /// @throws RendererError see RasterSampler
  bool advance();

 private:
  friend class BeamRefinement;

  void sample(const Grid& grid);
  void sample_evenly(const EvenGrids& even);
  void sample_page(const std::vector<BeamChoice>& choices, bool with_estimate);
  void sample_again(bool with_estimate);
  void learn();

  RasterSampler& sampler_;
  GpuBinner& binner_;
  const EchoRequest& request_;
  const SurfaceModel surface_;
  PingStatistics& statistics_;
  int pass_ = 0;
  std::vector<int> least_columns_;  ///< per beam, for the thin things in it
  std::vector<BeamState> beams_;
  // Of the last pass: the sampled beams and their grids.
  std::vector<BeamChoice> choices_;
  std::vector<Grid> grids_;
};

}  // namespace sonard::render
