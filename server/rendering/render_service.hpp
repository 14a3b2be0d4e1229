// SPDX-License-Identifier: Apache-2.0
// The render thread: owns the renderer and its GL context, takes jobs from the I/O thread, returns results.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "renderer/errors.hpp"
#include "renderer/ping.hpp"
#include "renderer/pose.hpp"
#include "server/rendering/posed_ping.hpp"

namespace sonard::server {

/// The renderer's interface to the service, so that tests can replace it. All calls come from the render
/// thread.
class PingRenderer {
 public:
  virtual ~PingRenderer() = default;
  /// The engine in use, one line.
  virtual std::string description() const = 0;
  /// @return false if the world has no such body
  virtual bool set_body_pose(const std::string& body, const render::Pose& T_world_body) = 0;
  /// @throws render::RequestError (this ping is impossible), render::RendererError (all pings are);
  /// std::bad_alloc (call forget() for the head)
  virtual render::PingSamples render_ping(const render::PingRequest& request, int head) = 0;
  /// Frees all caches of this head; its next ping is rendered like its first.
  virtual void forget(int /*head*/) {}
  /// Prepares the engine, trees, shaders and memory for such pings. Called once, before the first ping.
  /// @throws as render_ping()
  virtual void warm_up(const std::vector<render::HeadRequest>& /*first_pings*/) {}
  /// Whether begin_pings() can start anything, so that it is called.
  virtual bool begins_pings() const { return false; }
  /// Announces the pings that are rendered next, one by one; they move no body. Common work may start.
  /// @throws render::RendererError
  virtual void begin_pings(const std::vector<render::HeadRequest>& /*pings*/) {}
  /// Statistics of the last render_ping().
  virtual render::PingStatistics last_statistics() const = 0;
};

/// Makes the renderer; called once, on the render thread, because a GL context belongs to its thread.
using RendererFactory = std::function<std::unique_ptr<PingRenderer>()>;

struct RenderResult {
  render::PingSamples samples;  ///< empty if `error` is set
  std::string error;            ///< why this ping cannot be rendered; the service continues
  render::PingStatistics statistics;
};

/// Runs a function on the I/O thread, later. Callable from any thread.
using Post = std::function<void(std::function<void()>)>;

struct RenderServiceHooks {
  Post post;  ///< to the I/O thread
  /// Called once, on the I/O thread, if the renderer fails permanently. Nothing is rendered after that, and
  /// the daemon must not go on serving zeros.
  std::function<void(const std::string& what)> on_failure;
  /// Optional; called with each rendered ping on the render thread, before the result is returned.
  std::function<void(const PosedPing&, const render::PingSamples&)> observe;
};

/// Owns the render thread. All member functions are thread-safe, but stop() and the destructor must not run
/// at the same time.
///
/// Jobs wait in a queue of `head_count` places. Each head has at most one job outstanding, so the queue
/// cannot overflow. Shutdown: stop() drops the waiting jobs, lets the current ping finish, and joins. Results
/// already posted may still arrive after stop(); the submitter must accept that.
class RenderService {
 public:
  using Done = std::function<void(RenderResult)>;

  /// Returns when the renderer is made.
  /// @throws any exception of the factory
  RenderService(const RendererFactory& make_renderer, int head_count, RenderServiceHooks hooks);
  ~RenderService();
  RenderService(const RenderService&) = delete;
  RenderService& operator=(const RenderService&) = delete;

  /// Runs PingRenderer::warm_up(); returns when it is done.
  /// @throws any exception of warm_up(); std::future_error if the service is stopped first
  void warm_up(std::vector<render::HeadRequest> first_pings);
  /// Queues a ping. `done` is called on the I/O thread, unless the renderer fails or the service stops first.
  /// @throws std::logic_error if the queue is full: more than one job per head was submitted
  void submit(PosedPing ping, Done done);
  /// Drops the waiting job of a head; its `done` is never called. @return false if no job is waiting: it
  /// has begun and is answered as usual
  bool withdraw(int head);
  /// Ends the render thread after its current ping. Can be called again.
  void stop();

  /// PingRenderer::description() as of the newest ping: the GPU may have been lost since the start.
  std::string renderer_description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::server
