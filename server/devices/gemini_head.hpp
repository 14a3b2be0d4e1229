// A simulated Gemini 720i on its UDP socket.
#pragma once

#include <memory>
#include <optional>

#include "server/clock.hpp"
#include "server/config/config.hpp"
#include "server/devices/gemini_head_counters.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

class PoseHistory;
class RenderService;

/// What a head needs of the daemon. Everything outlives the head.
struct GeminiHeadServices {
  boost::asio::io_context& io;
  const Clock& clock;
  RenderService& renderer;
  const PoseHistory& poses;
  std::optional<double> water_surface_z_m;  ///< height above which a sonar is out of the water
  render::SkipSwitches skip{};              ///< for SkipRule::nobody_listening
};

/// Joins the pure gemini::Device with a socket, a timer, the pose history and the render thread. It decides
/// nothing about the protocol.
///
/// The constructor and destructor belong to the thread that owns the io_context while nobody runs it;
/// everything else, counters() included, to the I/O thread. At most one render job is outstanding. While the
/// socket is full the device stands still: nothing is dropped, and the pacing takes up again when the socket
/// drains.
///
/// Shutdown: stop() closes the sockets and cancels the timers. Handlers that are still queued, and an image
/// still being rendered, find the inner state stopped or gone and do nothing.
class GeminiHead {
 public:
  /// Boots the head and binds its sockets.
  /// @param stream number of this head among the users of the renderer
  /// @throws SocketError
  GeminiHead(const GeminiHeadConfig& config, int stream, const GeminiHeadServices& services);
  ~GeminiHead();
  GeminiHead(const GeminiHead&) = delete;
  GeminiHead& operator=(const GeminiHead&) = delete;

  void start();
  void stop();

  GeminiHeadCounters counters() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
