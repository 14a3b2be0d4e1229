// SPDX-License-Identifier: Apache-2.0
// The render thread: owns the renderer and its GL context, takes jobs from the I/O thread, hands results
// back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "renderer/errors.hpp"
#include "renderer/ping.hpp"
#include "renderer/pose.hpp"
#include "server/pose/posed_body.hpp"

namespace sonard::server {

/// The renderer's interface to the service, so that tests can replace it. All calls come from the
/// render thread.
class PingRenderer {
 public:
  virtual ~PingRenderer() = default;
  /// The engine in use, one line.
  virtual std::string description() const = 0;
  /// @return false when the world has no such body.
  virtual bool set_body_pose(const std::string& body, const render::Pose& T_world_body) = 0;
  /// @throws render::RequestError (this ping cannot be made), render::RendererError (none can);
  /// std::bad_alloc, and the stream is to be forgotten
  virtual render::PingSamples render_ping(const render::PingRequest& request, int stream) = 0;
  /// Gives back what is kept of this stream; its next ping is as its first one.
  virtual void forget(int /*stream*/) {}
  /// Prepares what pings like these need: the engine, trees, shaders, memory. Called once, before the first
  /// ping.
  /// @throws as render_ping()
  virtual void warm_up(const std::vector<render::StreamPing>& /*first_pings*/) {}
  /// These are rendered next, one by one; they move no body. What they have in common may begin.
  /// @throws render::RendererError
  virtual void begin_pings(const std::vector<render::StreamPing>& /*pings*/) {}
  /// Statistics of the last render_ping().
  virtual render::PingStatistics last_statistics() const = 0;
};

/// Makes the renderer; called once, on the render thread, where a GL context must be born.
using RendererFactory = std::function<std::unique_ptr<PingRenderer>()>;

/// One ping to render.
struct RenderJob {
  int stream = 0;                 ///< one per head, 0, 1, 2, ...
  std::string head;               ///< name of the head, for logs and dumps
  std::uint64_t transmit_us = 0;  ///< transmit time on the clock of the head, for logs and dumps
  std::int64_t pose_ns = 0;       ///< transmit time on the clock of the poses, for dumps
  render::PingRequest request;
  std::vector<PosedBody> bodies;  ///< moved before the ping is rendered
};

struct RenderResult {
  render::PingSamples samples;  ///< empty when `error` is not
  std::string error;            ///< why this ping cannot be made; the service continues
  render::PingStatistics statistics;
};

/// Runs a function on the I/O thread, later. Callable from any thread.
using Post = std::function<void(std::function<void()>)>;

struct RenderServiceHooks {
  Post post;  ///< to the I/O thread
  /// Called once, on the I/O thread, when the renderer fails for good. Nothing is rendered after that: a
  /// daemon that continued would serve zeros.
  std::function<void(const std::string& what)> on_failure;
  /// Optional; sees each rendered ping on the render thread before it is handed back.
  std::function<void(const RenderJob&, const render::PingSamples&)> observe;
};

/// Owns the render thread. Every member function may be called from any thread; stop() and the destructor
/// from one at a time.
///
/// Jobs wait in a queue of `stream_count` places: each head has at most one job outstanding, so it cannot
/// overflow. Shutdown: stop() forgets the waiting jobs, lets the ping being rendered finish, and joins.
/// Results already posted may still arrive after stop(); the submitter must tolerate that.
class RenderService {
 public:
  using Done = std::function<void(RenderResult)>;

  /// Returns when the renderer is made.
  /// @throws whatever the factory threw
  RenderService(const RendererFactory& make_renderer, int stream_count, RenderServiceHooks hooks);
  ~RenderService();
  RenderService(const RenderService&) = delete;
  RenderService& operator=(const RenderService&) = delete;

  /// PingRenderer::warm_up(); returns when it is done.
  /// @throws whatever that threw; std::future_error when the service is stopped before
  void warm_up(std::vector<render::StreamPing> first_pings);
  /// Queues a job. `done` is called on the I/O thread, unless the renderer fails or the service stops first.
  /// @throws std::logic_error when the queue is full: more than one job per stream was submitted
  void submit(RenderJob job, Done done);
  /// Forgets the waiting job of a stream; its `done` is never called. @return false when none is waiting: it
  /// has begun, and is answered as usual.
  bool withdraw(int stream);
  /// Ends the render thread after the ping it is working on. Harmless when called again.
  void stop();

  /// PingRenderer::description() as of the newest ping: a GPU may have been lost since the start.
  std::string renderer_description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::server
