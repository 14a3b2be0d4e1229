// From the backend that was asked for to the sampler that runs here.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "renderer/backend.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/spatial_index/spatial_index.hpp"
#include "renderer/visibility/raster_sampler.hpp"
#include "renderer/visibility/sampler.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

struct ChosenSampler {
  std::unique_ptr<Sampler> sampler;
  RasterSampler* raster = nullptr;  ///< the same, where it is that
  Backend backend = Backend::ray;   ///< never `automatic`
  /// What the sampler runs on and, where `automatic` chose it, what OpenGL there is.
  std::string description;
};

/// @param index of the world; it outlives the sampler.
/// @throws RendererError when `wanted` is `raster` and there is no OpenGL 4.5.
ChosenSampler choose_sampler(SpatialIndex& index, Backend wanted, WorkerPool& workers);

/// Whether the renderer string of an OpenGL context ("vendor / renderer / version") names a rasteriser that
/// runs on the CPU.
bool is_software_gl(std::string_view description);

}  // namespace sonard::render
