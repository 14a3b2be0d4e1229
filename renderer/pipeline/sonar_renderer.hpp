// SPDX-License-Identifier: Apache-2.0
// The entrance of the renderer: a world and a ping request go in, an echo image and the device's samples
// come out.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "renderer/errors.hpp"
#include "renderer/ping.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Renders pings of one world. Every call, construction and destruction included, comes from one thread,
/// which owns the GL context if there is one. Several sonars may share one renderer; each gives its own
/// `stream` number, which keeps their speckle apart.
class SonarRenderer {
 public:
  /// @throws RendererError when `gpu` is asked for and cannot be had.
  explicit SonarRenderer(const World& world, const RendererOptions& options = {});
  ~SonarRenderer();
  SonarRenderer(const SonarRenderer&) = delete;
  SonarRenderer& operator=(const SonarRenderer&) = delete;

  /// The engine of the next ping: `gpu` or `cpu`. It changes when the GPU fails: the ping at which it does
  /// already comes from the CPU.
  EngineKind engine() const;
  /// That engine and what it runs on, in one line.
  const std::string& engine_description() const;
  /// Takes this engine from the next ping on, and gives the GPU up when it is `cpu`.
  /// @param engine not `automatic`; choose_engine() finds the faster one.
  /// @throws RendererError when it cannot be had; the one in use stays.
  void use_engine(EngineKind engine);

  /// Moves a body of the world. @return false when the world has no body of that name.
  bool set_body_pose(const std::string& body_name, const Pose& T_world_body);

  /// Has the mean echoes of these pings made at the same time, for their turn to be rendered; the results are
  /// the same without. Does nothing where that gains nothing: on the CPU, and where a ping changes what the
  /// engine draws, as with motion within a ping, terrain in levels and bent rays.
  /// @param pings of different streams
  /// @throws RendererError
  void begin_pings(std::span<const StreamPing> pings);

  /// Mean echo only: no speckle, noise or gain. The image stays valid until the next call for this stream; as
  /// long as nothing that it depends on changes (SkipRule::unchanged_scene), the same one is handed out.
  /// @throws RequestError, RendererError
  const EchoImage& render_echo(const PingRequest& request, int stream = 0);

  /// Renders the samples of a ping. The bytes depend on the history of requests of this stream; with speckle
  /// `frozen` or `per_ping` on this request alone.
  /// @throws RequestError, RendererError; std::bad_alloc, and the stream is to be forgotten
  PingSamples render_ping(const PingRequest& request, int stream = 0);

  /// Gives back what is kept of this stream; its next ping is as its first one.
  void forget(int stream);

  /// Advances all that this stream keeps from ping to ping as render_ping() would, in a fraction of its time:
  /// rendering every n-th ping of a run gives the bytes of the whole run.
  /// @return false, and does nothing, when that depends on the echo: where pulses are shorter than a line,
  /// speckle `ou` evolves only in lines with an echo. Use render_ping() then.
  /// @throws RequestError
  bool pass_ping(const PingRequest& request, int stream = 0);

  const PingStatistics& last_statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
