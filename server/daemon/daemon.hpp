// SPDX-License-Identifier: Apache-2.0
// The daemon: joins pose sources, heads and render threads, from start to signal.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "renderer/renderer_options.hpp"
#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"
#include "server/rendering/render_service.hpp"

namespace sonard::server {

class Playback;

/// Reads the world of a configuration.
/// @throws render::WorldError, also if the world has no triangles and is not declared open water
render::World read_world(const WorldConfig& config);

/// Reads the world and resolves configuration values that depend on it (resolve_mounts()). Logs warnings and
/// ignored parts of the world.
/// @throws Error
render::World load_world_of(DaemonConfig& config);

/// Options of the renderer for a configuration.
render::RendererOptions renderer_options(const DaemonConfig& config);

/// Returns why the daemon cannot restart and goes on; nullopt if it ends to restart. Runs on its own thread;
/// must return when a stop is requested.
using ReloadCheck = std::function<std::optional<std::string>(const std::stop_token&)>;

/// Loads the world, starts the renderer (self-test first), binds the sockets and serves until SIGINT or
/// SIGTERM, which end it within the time of one ping. When ready it logs one line that begins with "sonard
/// ready". By then it has rendered and dropped one ping of each head, so that a client's first ping is as
/// fast as later ones. Another signal a second or more after the first kills at once.
/// @param may_begin_anew called at SIGHUP. Empty: SIGHUP only logs a line.
/// @return exit_clean; begins_anew; exit_renderer if the renderer fails while serving; exit_internal;
/// exit_exhausted
/// @throws Error if a value of the configuration proves unusable: a world is missing, an address is taken
int run_daemon(DaemonConfig config, const ReloadCheck& may_begin_anew = {});

inline constexpr int begins_anew = -1;  ///< not an exit code: the daemon has ended and must be started again

/// Runs the daemon with a loaded world and any renderer; for replay, and for tests without rendering.
/// @param playback the pings of heads that play back a recording; the daemon ends when it is finished. May be
/// null.
int serve(const DaemonConfig& config, const render::World& world, const RendererFactory& make_renderer,
          Playback* playback = nullptr, const ReloadCheck& may_begin_anew = {});

}  // namespace sonard::server
