// SPDX-License-Identifier: Apache-2.0
// Renderer of the render thread: a world and an engine.
#pragma once

#include <filesystem>

#include "renderer/renderer_options.hpp"
#include "renderer/scene/world.hpp"
#include "server/rendering/render_service.hpp"

namespace sonard::server {

/// A factory for RenderService; the world outlives it. It runs the self-test first, so that a broken engine
/// never serves a socket. With `engine: auto`, the renderer measures both engines in warm_up(). It keeps the
/// faster one in the file `choices` for the next start (EngineChoiceFile; empty: measures at each start).
RendererFactory world_renderer_factory(const render::World& world, render::RendererOptions options,
                                       std::filesystem::path choices);

}  // namespace sonard::server
