// SPDX-License-Identifier: Apache-2.0
// The engine that was asked for and, where that fails, the other.
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

/// Images come from the GPU until it fails; those at which it does, and all that follow, come from the CPU.
/// Each engine is made when it is first used, of the world as it is by then.
class EngineSwitch final : public EchoEngine {
 public:
  /// @param index where the world is moved; it and the workers outlive this object.
  /// @throws RendererError when `gpu` is asked for and cannot be had.
  EngineSwitch(SpatialIndex& index, WorkerPool& workers, const RendererOptions& options);

  /// The engine of the next image.
  EngineKind kind() const { return gpu_ ? EngineKind::gpu : EngineKind::cpu; }
  /// Takes this one from the next image on, and gives the GPU up when it is `cpu`.
  /// @param engine not `automatic`
  /// @throws RendererError when it cannot be had; the one in use stays.
  void use(EngineKind engine);
  /// Where the GPU fails, all of them come from the CPU; where it cannot hold what one of them takes, that
  /// one.
  void images(std::span<const EchoJob> jobs) override;
  void set_body_pose(std::size_t body, const Pose& T_world_body) override;
  void set_part_meshes(std::span<const PartMesh> changes) override;
  void set_refraction(double bend_per_m) override;
  /// Of the engine in use; where the GPU was lost, with the reason.
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
  std::unique_ptr<EchoEngine> cpu_, gpu_;  ///< null: not made yet, or given up
  bool wants_gpu_ = false;                 ///< without `gpu_` it is lost
  bool told_too_large_ = false;
  std::string lost_because_;
  Stopwatch watch_;
  double since_loss_s_ = 0.0;
  std::string description_;
};

}  // namespace sonard::render
