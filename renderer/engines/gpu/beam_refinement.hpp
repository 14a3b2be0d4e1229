// SPDX-License-Identifier: Apache-2.0
// Grids of samples that are as fine as each beam needs (docs/accuracy.md).
#pragma once

#include <list>
#include <memory>
#include <vector>

#include "renderer/engine.hpp"
#include "renderer/engines/gpu/gpu_binner.hpp"
#include "renderer/engines/gpu/grid_choice.hpp"
#include "renderer/engines/gpu/raster_sampler.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

/// Samples the whole fan with an even grid, lets the GPU estimate the error of every beam, and samples those
/// that may miss the preset's targets again. All passes depend on the request alone, so the image does. One
/// thread uses it.
class BeamRefinement {
 public:
  /// @param sampler, binner outlive this object; the context of the sampler is current when it ends.
  BeamRefinement(RasterSampler& sampler, GpuBinner& binner) : sampler_(sampler), binner_(binner) {}

  /// Puts the beams of a request into the image that the binner has begun.
  /// @param keep_grid the grid of the first pass may be that of an earlier ping, where it is equal.
  /// @return whether it was.
  /// @throws RequestError when the aperture cannot be gridded.
  /// @throws RendererError as the sampler.
  bool refine(const EchoRequest& request, const SurfaceModel& surface, bool keep_grid,
              PingStatistics& statistics);

 private:
  /// A grid of some beams, and what of it the GPU holds.
  struct Grid {
    SampleGrid samples;
    std::shared_ptr<const GpuGrid> on_gpu;
  };
  /// The even grids of the first pass, one for each page of the image.
  struct EvenGrids {
    Aperture aperture;
    BeamDensity density;
    int beams_per_page;
    std::vector<Grid> grids;
  };
  struct Ping;

  Grid make_grid(const Aperture& aperture, const std::vector<BeamRun>& runs, bool with_estimate) const;
  const EvenGrids* known_even_grids(const Aperture& aperture, const BeamDensity& density);
  const EvenGrids& make_even_grids(const Aperture& aperture, const BeamDensity& density);

  RasterSampler& sampler_;
  GpuBinner& binner_;
  std::list<EvenGrids> even_;  ///< the last used first: heads that share a renderer come in turn
};

}  // namespace sonard::render
