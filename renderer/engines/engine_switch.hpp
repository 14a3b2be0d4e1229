// SPDX-License-Identifier: Apache-2.0
// The selected engine and, if the GPU fails, the CPU engine.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "renderer/engine.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/spatial_index/spatial_index.hpp"
#include "renderer/stopwatch.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Images come from the selected engine. The images at which the GPU fails, and all later ones, come from the
/// CPU, until the GPU is back (GpuOptions::retry_s). Each engine is made on first use, from the current
/// world.
class EngineSwitch final : public EchoEngine {
 public:
  /// @param index moves the world; it and the workers must outlive this object
  /// @throws RendererError if `gpu` is selected and not available
  EngineSwitch(SpatialIndex& index, WorkerPool& workers, const RendererOptions& options);

  /// The engine of the next image.
  EngineKind kind() const { return gpu_ ? EngineKind::gpu : EngineKind::cpu; }
  /// Selects the engine from the next image on; `cpu` releases the GPU.
  /// @param engine not `automatic`
  /// @throws RendererError if it is not available; the current one stays
  void use(EngineKind engine);
  /// If the GPU fails, all these images come from the CPU. If one image does not fit on the GPU, only that
  /// one comes from the CPU.
  void images(std::span<const EchoJob> jobs) override;
  void set_body_pose(std::size_t body, const Pose& T_world_body) override;
  void set_part_meshes(std::span<const PartMesh> changes) override;
  void set_refraction(double bend_per_m) override;
  /// Description of the current engine, with the reason if the GPU was lost.
  const std::string& description() const override { return description_; }

 private:
  EchoEngine& cpu();
  void make_gpu();
  void lose_gpu(const std::string& reason);
  void retry_gpu();
  bool images_by_gpu(std::span<const EchoJob> jobs, std::string& too_large);
  void describe();
  void report(const std::string& line) const;

  SpatialIndex& index_;
  WorkerPool& workers_;
  const RendererOptions options_;
  double bend_per_m_ = 0.0;
  std::unique_ptr<EchoEngine> cpu_, gpu_;  ///< null: not made yet, or released
  bool wants_gpu_ = false;                 ///< true without `gpu_`: the GPU is lost
  bool told_too_large_ = false;
  std::string lost_because_;
  Stopwatch watch_;
  double since_loss_s_ = 0.0;
  std::string description_;
};

}  // namespace sonard::render
