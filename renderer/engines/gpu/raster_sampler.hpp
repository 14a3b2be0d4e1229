// SPDX-License-Identifier: Apache-2.0
// Visibility by rasterising: OpenSceneGraph culls and draws, a fragment shader writes one SurfaceSample per
// pixel.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

class EglContext;
class VideoMemory;

/// Owns an EGL context and the world's copy on the GPU. All coordinates on the GPU are relative to the sonar;
/// the CPU subtracts world positions in double, once per body and ping.
class RasterSampler {
 public:
  /// @throws RendererError without OpenGL 4.5, or if a shader does not compile
  explicit RasterSampler(const World& world, const GpuOptions& options = {});
  ~RasterSampler();
  RasterSampler(const RasterSampler&) = delete;
  RasterSampler& operator=(const RasterSampler&) = delete;

  /// The samples of each view, row after row in the order of SubView; valid until the next call of draw() or
  /// sample(). Surfaces beyond `max_range_m` may be missing.
  /// @throws RequestError if a view exceeds the size of textures, or if drawing takes more video memory than
  /// the options allow
  /// @throws RendererError if OpenGL fails
  std::vector<const SurfaceSample*> sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                           const SurfaceModel& surface, double max_range_m);

  // For these three, see EchoEngine.
  void set_body_pose(std::size_t body, const Pose& T_world_body);
  void set_part_meshes(std::span<const PartMesh> changes);
  void set_refraction(double bend_per_m);

  /// Video memory of meshes and normal maps, without views.
  const VideoMemory& video_memory() const;

  /// "gpu, vendor / renderer / version"
  const std::string& description() const;

  /// Sums since construction.
  struct Drawn {
    std::uint64_t views = 0, pixels = 0, draw_calls = 0, triangles = 0;
    double culling_s = 0.0;
  };
  const Drawn& drawn() const;

  /// Like sample(), but the samples stay on the GPU.
  /// @return name of an array of textures (RGBA32F, one SurfaceSample per texel) with the views at the places
  /// of lay_out(); valid until the next call of draw() or sample()
  unsigned draw(const Pose& T_world_sonar, const SampleGrid& grid, const SurfaceModel& surface,
                double max_range_m);
  /// Makes the context of the texture current and returns it.
  /// @throws RendererError if the context is lost
  EglContext& current_context();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
