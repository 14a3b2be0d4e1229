// SPDX-License-Identifier: Apache-2.0
// Entry point of the renderer: it turns a world and a ping request into an echo image and the device's
// samples.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "renderer/errors.hpp"
#include "renderer/ping.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Renders pings of one world. All calls, including construction and destruction, must come from one thread,
/// which owns the GL context if there is one. Several heads may share one renderer; each has its own
/// index, which separates their speckle.
class SonarRenderer {
 public:
  /// @throws RendererError if `gpu` is requested but unavailable.
  explicit SonarRenderer(const World& world, const RendererOptions& options = {});
  ~SonarRenderer();
  SonarRenderer(const SonarRenderer&) = delete;
  SonarRenderer& operator=(const SonarRenderer&) = delete;

  /// The engine of the next ping: `gpu` or `cpu`. It changes when the GPU fails; the CPU then renders the
  /// failed ping, too.
  EngineKind engine() const;
  /// The present engine and its hardware, in one line.
  const std::string& engine_description() const;
  /// Uses this engine from the next ping on; `cpu` releases the GPU.
  /// @param engine not `automatic`; choose_engine() finds the faster one.
  /// @throws RendererError if it is unavailable; the present engine stays in use.
  void use_engine(EngineKind engine);

  /// Moves a body of the world. @return false if the world has no body of this name.
  bool set_body_pose(const std::string& body_name, const Pose& T_world_body);

  /// Renders the mean echoes of these pings in parallel, in advance; the later results are the same as
  /// without. Does nothing if there is no gain: on the CPU, and if a ping changes what the engine draws
  /// (motion within a ping, terrain in levels, bent rays).
  /// @param pings of different heads
  /// @throws RendererError
  void begin_pings(std::span<const HeadRequest> pings);

  /// Renders the mean echo only: no speckle, noise or gain. The image stays valid until the next call for
  /// this head. If nothing it depends on has changed (SkipRule::unchanged_scene), the call returns the same
  /// image.
  /// @throws RequestError, RendererError
  const EchoImage& render_echo(const PingRequest& request, int head = 0);

  /// The same for settings with directions: the strongest echo of each, also without speckle and noise.
  /// @throws RequestError, RendererError
  const DirectionEchoes& render_directions(const PingRequest& request, int head = 0);

  /// Renders the samples of a ping. The bytes depend on the earlier requests of this head; with speckle
  /// `frozen` or `per_ping`, only on this request.
  /// @throws RequestError, RendererError; std::bad_alloc, after which the caller must forget() the head
  PingSamples render_ping(const PingRequest& request, int head = 0);

  /// Drops the history of this head; its next ping is rendered like its first one.
  void forget(int head);

  /// Advances the history of this head like render_ping(), in a fraction of its time: rendering every n-th
  /// ping of a run gives the same bytes as the whole run.
  /// @return false, without any change, if this depends on the echo: if pulses are shorter than a line,
  /// speckle `ou` evolves only in lines with an echo. Use render_ping() then.
  /// @throws RequestError
  bool pass_ping(const PingRequest& request, int head = 0);

  const PingStatistics& last_statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
