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

/// Owns an EGL context and the world's copy on the GPU. All coordinates on the GPU are relative to the sonar:
/// the subtraction of world positions happens in double on the CPU, once per body and ping.
class RasterSampler {
 public:
  /// @param device as GpuOptions::device.
  /// @throws RendererError without OpenGL 4.5, or when a shader does not compile.
  explicit RasterSampler(const World& world, const GpuOptions& options = {});
  ~RasterSampler();
  RasterSampler(const RasterSampler&) = delete;
  RasterSampler& operator=(const RasterSampler&) = delete;

  /// The samples of view i, row after row as SubView orders them. They stay valid until the next call of
  /// draw() or sample(). Surfaces beyond `max_range_m` may be reported or not.
  /// @throws RequestError when a view is larger than a texture can be, or what is to be drawn takes more
  /// video memory than the options allow.
  /// @throws RendererError when OpenGL fails.
  std::vector<const SurfaceSample*> sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                           const SurfaceModel& surface, double max_range_m);

  // These three do what EchoEngine says.
  void set_body_pose(std::size_t body, const Pose& T_world_body);
  void set_part_meshes(std::span<const PartMesh> changes);
  void set_refraction(double bend_per_m);

  /// Meshes and normal maps; what views take is not in it.
  const VideoMemory& video_memory() const;

  /// "gpu, vendor / renderer / version"
  const std::string& description() const;

  /// How much has been drawn since the beginning, and what culling took.
  struct Drawn {
    std::uint64_t views = 0, pixels = 0, draw_calls = 0, triangles = 0;
    double culling_s = 0.0;
  };
  const Drawn& drawn() const;

  /// What lay_out() is told.
  int most_view_px() const;
  /// Like sample(), but the samples stay on the GPU.
  /// @return name of an array of textures (RGBA32F, a SurfaceSample each texel), in which the views are as
  /// lay_out() says. Stays valid until the next call of draw() or sample().
  unsigned draw(const Pose& T_world_sonar, const SampleGrid& grid, const SurfaceModel& surface,
                double max_range_m);
  /// Where the texture is, made current.
  /// @throws RendererError when the context is lost.
  EglContext& current_context();
  /// For what ends: does nothing when the context is lost.
  void make_current_if_alive();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
