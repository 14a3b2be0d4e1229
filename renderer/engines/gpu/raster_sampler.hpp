// SPDX-License-Identifier: Apache-2.0
// Visibility by rasterising: OpenSceneGraph culls and draws, a fragment shader writes one SurfaceSample per
// pixel.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/pose.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

/// Draws one view of a grid after the other. All coordinates on the GPU are relative to the sonar; the CPU
/// subtracts world positions in double, once per body and ping.
class RasterSampler {
 public:
  /// @param context current in every call; must outlive the sampler
  /// @param world must outlive the sampler; its poses and meshes may change between calls
  /// @param bound_bytes of meshes and normal maps in video memory
  /// @throws RendererError if a shader does not compile
  RasterSampler(EglContext& context, const World& world, std::uint64_t bound_bytes);
  ~RasterSampler();
  RasterSampler(const RasterSampler&) = delete;
  RasterSampler& operator=(const RasterSampler&) = delete;

  /// The samples of each view, row after row in the order of SubView; valid until the next call. Surfaces
  /// beyond `max_range_m` may be missing.
  /// @param bend_per_m see EchoEngine::set_refraction()
  /// @throws RequestError if a view exceeds the size of textures, or if what it sees exceeds the bound
  /// @throws RendererError if OpenGL fails
  std::vector<const SurfaceSample*> sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                           const SurfaceModel& surface, float bend_per_m, double max_range_m);

  /// Of meshes and normal maps in video memory.
  std::uint64_t bytes() const;
  /// Sum since construction, including repeated uploads.
  std::uint64_t bytes_uploaded() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
