// SPDX-License-Identifier: Apache-2.0
// What the render thread renders with: a world and an engine.
#pragma once

#include "renderer/renderer_options.hpp"
#include "renderer/scene/world.hpp"
#include "server/rendering/render_service.hpp"

namespace sonard::server {

/// For RenderService; the world outlives the factory. What it makes measures, under `auto`, both engines when
/// it is warmed up. The self-test comes first: an engine that draws nothing must not get as far as a socket.
RendererFactory world_renderer_factory(const render::World& world, render::RendererOptions options);

}  // namespace sonard::server
