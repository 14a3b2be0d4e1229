// SPDX-License-Identifier: Apache-2.0
// The engine on the GPU: slices by compute shaders for presets, drawn samples for fixed grids and cones.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/engine.hpp"
#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gpu_echoes.hpp"
#include "renderer/engines/gpu/gpu_slices.hpp"
#include "renderer/engines/gpu/raster_sampler.hpp"
#include "renderer/engines/slices/slice_world.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/sample_grid/grid_cache.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

class GpuEngine final : public EchoEngine {
 public:
  static constexpr std::size_t most_pings = 8;  ///< in flight

  /// @param workers must outlive the engine
  /// @throws RendererError without OpenGL 4.5, or if a shader does not build
  GpuEngine(const World& world, WorkerPool& workers, const RendererOptions& options);
  ~GpuEngine() override;

  void images(std::span<const EchoJob> jobs) override;
  void set_body_pose(std::size_t body, const Pose& T_world_body) override;
  void set_part_meshes(std::span<const PartMesh> changes) override;
  void set_refraction(double bend_per_m) override;
  const std::string& description() const override { return description_; }

 private:
  struct Ping;

  void images_by_slices(std::span<const EchoJob> jobs);
  void begin(Ping& ping);
  void finish(Ping& ping);
  void image_by_grid(const EchoJob& job, const BinningOptions& options);

  const SkipSwitches skip_;
  const std::uint64_t memory_bound_bytes_;  ///< of slices, and as much of grids
  const float largest_response_;
  World drawn_;  ///< for grids; refractable if rays may bend
  WorkerPool& workers_;
  std::uint64_t images_until_lost_;  ///< GpuOptions::lose_context_at_image
  osg::ref_ptr<EglContext> context_;
  std::string description_;
  SliceWorld world_;
  GpuSlices slices_;
  GpuEchoes echoes_;
  std::vector<std::unique_ptr<PingBuffers>> buffers_;  ///< one per ping in flight
  std::unique_ptr<RasterSampler> raster_;              ///< made when first used
  GridCache grid_;
};

}  // namespace sonard::render
