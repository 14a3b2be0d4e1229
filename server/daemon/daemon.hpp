// SPDX-License-Identifier: Apache-2.0
// The daemon: pose sources, heads and the render thread joined, from start to signal.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "renderer/renderer_options.hpp"
#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"
#include "server/rendering/render_service.hpp"

namespace sonard::server {

class Playback;

/// The value of a configuration key turned out to be unusable when it was used: world missing, address taken.
/// what() is one line.
struct StartError : std::runtime_error {
  StartError(std::string config_key, int code, const std::string& what,
             std::vector<std::string> what_else = {})
      : std::runtime_error(what), key(std::move(config_key)), exit_code(code), more(std::move(what_else)) {}

  std::string key;                ///< "heads[0].network.bind"
  int exit_code;                  ///< of server/daemon/exit_codes.hpp
  std::vector<std::string> more;  ///< what else is wrong with the same key
};

/// The world of a configuration.
/// @throws render::WorldError, also of a world without triangles that is not said to be open water
render::World read_world(const DaemonConfig& config);

/// The same for a configuration which takes from it what it leaves to its world (resolve_mounts()). Logs
/// what is odd about it, and what is left out.
/// @throws StartError
render::World load_world_of(DaemonConfig& config);

/// What a renderer is made with.
render::RendererOptions renderer_options(const DaemonConfig& config);

/// Why the daemon cannot begin anew and goes on; nullopt: it ends, to begin anew. Called on a thread of its
/// own; a requested stop ends it.
using ReloadCheck = std::function<std::optional<std::string>(const std::stop_token&)>;

/// Loads the world, starts the renderer (self-test first), binds the sockets and serves until SIGINT or
/// SIGTERM, which end it within the time of one ping. When all is up it logs one line that begins with
/// "sonard ready": one ping of each head has then been rendered and dropped, so that the first one for
/// a client takes no longer than others. A signal a second after the first kills at once.
/// @param may_begin_anew asked at SIGHUP. Empty: SIGHUP is one line in the log.
/// @return exit_clean; begins_anew; exit_renderer when the renderer fails while serving; exit_internal
/// @throws StartError, render::RendererError, render::RequestError, std::system_error before it is ready
int run_daemon(DaemonConfig config, const ReloadCheck& may_begin_anew = {});

inline constexpr int begins_anew = -1;  ///< no exit code: the daemon has ended, and is to be started again

/// Runs the daemon with a loaded world and any renderer; for replay, and for tests without rendering.
/// @param playback what heads play back that are told to; the daemon ends when it is finished. May be null.
int serve(const DaemonConfig& config, const render::World& world, const RendererFactory& make_renderer,
          Playback* playback = nullptr, const ReloadCheck& may_begin_anew = {});

}  // namespace sonard::server
