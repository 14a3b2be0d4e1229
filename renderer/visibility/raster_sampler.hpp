// Visibility by rasterising: OpenSceneGraph culls and draws, a fragment shader writes one SurfaceSample per
// pixel.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/scene/world.hpp"
#include "renderer/visibility/sampler.hpp"

namespace sonard::render {

/// Owns an EGL context and the world's copy on the GPU. All coordinates on the GPU are relative to the sonar:
/// the subtraction of world positions happens in double on the CPU, once per body and ping.
class RasterSampler final : public Sampler {
 public:
  /// @throws RendererError without OpenGL 4.5, or when a shader does not compile.
  explicit RasterSampler(const World& world);
  ~RasterSampler() override;

  std::vector<const SurfaceSample*> sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                           const SurfaceModel& surface, double max_range_m) override;
  bool set_body_pose(const std::string& body_name, const Pose& T_world_body) override;
  const std::string& description() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
