// SPDX-License-Identifier: Apache-2.0
// Grids of samples that are as fine as each beam needs (docs/accuracy.md).
#pragma once

#include <optional>
#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/engines/gpu/grid_choice.hpp"
#include "renderer/engines/gpu/raster_sampler.hpp"
#include "renderer/pose.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/surface/surface_model.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Samples the whole fan with an even grid, estimates the error of every beam, and samples those that may
/// miss the preset's targets again. All passes depend on the request alone, so the image does. One thread
/// uses it.
class BeamRefinement {
 public:
  /// @param sampler, workers outlive this object.
  BeamRefinement(RasterSampler& sampler, WorkerPool& workers) : sampler_(sampler), workers_(workers) {}

  /// What all passes of a ping share.
  struct Request {
    const Pose& T_world_sonar;
    const SonarSettings& settings;
    const SurfaceModel& surface;
    double max_range_m;
    const BinningOptions& binning;
    /// What the echo of each line is yet to be multiplied with; empty: 1.
    const std::vector<float>& line_weight;
  };
  struct Result {
    BinningResult bins;         ///< `samples` and `invalid_samples` are those of all passes
    double visibility_s = 0.0;  ///< of the time taken
    bool known_grid = false;    ///< the grid of the first pass was that of the last ping
  };

  /// @param keep_grid the grid of the first pass may be that of the last ping, where it is equal.
  /// @throws RequestError when the aperture cannot be gridded.
  /// @throws RendererError as the sampler.
  Result refine(const Request& request, bool keep_grid);

 private:
  /// The even grid of the first pass, and that grid thinned.
  struct EvenGrid {
    Aperture aperture;
    BeamDensity density;
    SampleGrid grid, coarse;
  };

  struct Ping;
  const EvenGrid& even_grid(const Aperture& aperture, const BeamDensity& density);

  RasterSampler& sampler_;
  WorkerPool& workers_;
  std::optional<EvenGrid> even_;
};

}  // namespace sonard::render
