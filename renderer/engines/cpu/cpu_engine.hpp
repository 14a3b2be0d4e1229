// SPDX-License-Identifier: Apache-2.0
// The engine without graphics: exact visibility in azimuth slices for presets, rays for fixed grids.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "renderer/binning/binning.hpp"
#include "renderer/engine.hpp"
#include "renderer/engines/cpu/ray_sampler.hpp"
#include "renderer/engines/cpu/slice_sampler.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/sample_grid/grid_cache.hpp"
#include "renderer/spatial_index/spatial_index.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

class CpuEngine final : public EchoEngine {
 public:
  /// @param index moves the world; only a fixed grid traces rays through it. It must outlive the engine.
  /// @param workers must outlive the engine
  CpuEngine(SpatialIndex& index, WorkerPool& workers, const RendererOptions& options);

  void images(std::span<const EchoJob> jobs) override;
  void set_body_pose(std::size_t body, const Pose& T_world_body) override;
  void set_part_meshes(std::span<const PartMesh> changes) override;
  void set_refraction(double bend_per_m) override;
  const std::string& description() const override { return description_; }

 private:
  void image_by_grid(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                     PingStatistics& statistics);
  void image_by_slices(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                       PingStatistics& statistics);

  const SkipSwitches skip_;
  const float largest_response_;
  WorkerPool& workers_;
  std::unique_ptr<SpatialIndex>
      bendable_;  ///< the world with facets that bend with the rays; null without refraction
  SliceSampler slices_;
  RaySampler rays_;
  GridCache grid_;
  std::string description_;
};

}  // namespace sonard::render
