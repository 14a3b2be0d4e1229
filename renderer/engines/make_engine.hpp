// SPDX-License-Identifier: Apache-2.0
// From the engine that was asked for to the engine that runs here.
#pragma once

#include <memory>
#include <string>

#include "renderer/engine.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/spatial_index/spatial_index.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

struct ChosenEngine {
  std::unique_ptr<EchoEngine> engine;
  EngineKind kind = EngineKind::cpu;  ///< never `automatic`
  /// What the engine runs on and, where `automatic` chose it, what OpenGL there is.
  std::string description;
};

/// @param index where the world is moved; it and the workers outlive the engine.
/// @throws RendererError when `gpu` is asked for and there is no OpenGL 4.5, or binning on the GPU and its
/// shaders do not build.
ChosenEngine make_engine(SpatialIndex& index, WorkerPool& workers, const RendererOptions& options);

}  // namespace sonard::render
