// SPDX-License-Identifier: Apache-2.0
// What the render thread renders with: a world and an engine.
#pragma once

#include <filesystem>

#include "renderer/renderer_options.hpp"
#include "renderer/scene/world.hpp"
#include "server/rendering/render_service.hpp"

namespace sonard::server {

/// For RenderService; the world outlives the factory. What it makes measures, under `auto`, both engines when
/// it is warmed up, and keeps in `choices` which was faster, for the next start (EngineChoiceFile; empty: it
/// measures each time). The self-test comes first: an engine that draws nothing must not get as far as a
/// socket.
RendererFactory world_renderer_factory(const render::World& world, render::RendererOptions options,
                                       std::filesystem::path choices);

}  // namespace sonard::server
