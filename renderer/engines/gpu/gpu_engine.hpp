// SPDX-License-Identifier: Apache-2.0
// The engine that draws with OpenGL and bins on the same device.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/engine.hpp"
#include "renderer/engines/gpu/beam_refinement.hpp"
#include "renderer/engines/gpu/gpu_binner.hpp"
#include "renderer/engines/gpu/raster_sampler.hpp"
#include "renderer/engines/gpu/thin_things.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/sample_grid/grid_cache.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

class GpuEngine final : public EchoEngine {
 public:
  /// @param workers must outlive the engine
  /// @throws RendererError without OpenGL 4.5, or if a shader does not build
  GpuEngine(const World& world, WorkerPool& workers, const RendererOptions& options);
  ~GpuEngine() override;

  void images(std::span<const EchoJob> jobs) override;
  void set_body_pose(std::size_t body, const Pose& T_world_body) override;
  void set_part_meshes(std::span<const PartMesh> changes) override;
  void set_refraction(double bend_per_m) override;
  const std::string& description() const override { return sampler_.description(); }

 private:
  struct Making;

  GpuBinner& binner(std::size_t number);
  void images_together(std::span<const EchoJob> jobs);
  template <class Step>
  void count(PingStatistics& statistics, Step step);
  void begin(Making& image);
  static void advance(Making& image);
  static void finish(Making& image);
  void draw_grid(GpuBinner& binner, const EchoRequest& request, bool may_keep, PingStatistics& statistics);
  void image_by_cones(const EchoRequest& request, const BinningOptions& options, MeanEcho& echo,
                      PingStatistics& statistics);

  const SkipSwitches skip_;
  const float largest_response_;
  WorkerPool& workers_;
  std::uint64_t images_until_lost_;  ///< GpuOptions::lose_context_at_image
  std::uint64_t merged_facets_ = 0;  ///< SkipRule::coplanar_facets
  ThinThings thin_things_;
  RasterSampler sampler_;
  std::vector<std::unique_ptr<GpuBinner>> binners_;  ///< one per image in progress
  GridCache grid_, cone_grid_;
  std::vector<std::shared_ptr<const GpuGrid>> grid_on_gpu_;  ///< one per page of the image
  int grid_page_ = 0;                                        ///< beams per page
  BeamRefinement refinement_;
};

}  // namespace sonard::render
