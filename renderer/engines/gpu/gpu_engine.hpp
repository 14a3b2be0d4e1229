// SPDX-License-Identifier: Apache-2.0
// The engine that draws with OpenGL: presets are refined beam by beam, fixed grids binned where they are
// drawn.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "renderer/backend.hpp"
#include "renderer/binning/binning.hpp"
#include "renderer/engine.hpp"
#include "renderer/engines/gpu/beam_refinement.hpp"
#include "renderer/engines/gpu/gpu_binner.hpp"
#include "renderer/engines/gpu/raster_sampler.hpp"
#include "renderer/sample_grid/grid_cache.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

class GpuEngine final : public EchoEngine {
 public:
  /// @param workers outlives the engine.
  /// @throws RendererError without OpenGL 4.5, when a shader does not build, or when binning on the GPU is
  /// asked for and cannot be had.
  GpuEngine(const World& world, WorkerPool& workers, const RendererOptions& options);

  void image(const EchoRequest& request, MeanEcho& echo, PingStatistics& statistics) override;
  void set_body_pose(std::size_t body, const Pose& T_world_body) override;
  void set_part_meshes(std::span<const PartMesh> changes) override;
  void set_refraction(double bend_per_m) override;
  const std::string& description() const override { return description_; }

 private:
  void make_binner(GpuBinning wanted);
  void image_by_grid(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                     PingStatistics& statistics);
  void image_by_refinement(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                           PingStatistics& statistics);

  const SkipSwitches skip_;
  const float largest_response_;
  WorkerPool& workers_;
  RasterSampler sampler_;
  std::string description_;
  std::optional<GpuBinner> binner_;  ///< nullopt: all binning is the CPU's
  GridCache grid_;
  BeamRefinement refinement_;
};

}  // namespace sonard::render
