// Visibility by rasterising: OpenSceneGraph culls and draws, a fragment shader writes one SurfaceSample per
// pixel.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/scene/world.hpp"
#include "renderer/visibility/sampler.hpp"

namespace sonard::render {

class EglContext;

/// Owns an EGL context and the world's copy on the GPU. All coordinates on the GPU are relative to the sonar:
/// the subtraction of world positions happens in double on the CPU, once per body and ping.
class RasterSampler final : public Sampler {
 public:
  /// @throws RendererError without OpenGL 4.5, or when a shader does not compile.
  explicit RasterSampler(const World& world);
  ~RasterSampler() override;

  std::vector<const SurfaceSample*> sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                           const SurfaceModel& surface, double max_range_m) override;
  void set_body_pose(std::size_t body, const Pose& T_world_body) override;
  void set_part_meshes(std::span<const PartMesh> changes) override;
  void set_ray_bend(double bend_per_m) override;
  const std::string& description() const override;

  /// As sample(), but what is seen stays on the GPU.
  /// @return names of textures, one for every view: RGBA32F, a SurfaceSample each texel, row by row upwards.
  /// They stay valid until the next call of draw() or sample().
  std::vector<unsigned> draw(const Pose& T_world_sonar, const SampleGrid& grid, const SurfaceModel& surface,
                             double max_range_m);
  /// Where these textures are, made current.
  /// @throws RendererError when the context is lost.
  EglContext& current_context();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
