// A simulated Gemini 720i on its UDP socket.
#pragma once

#include <memory>

#include "server/config/config.hpp"
#include "server/devices/gemini_head_counters.hpp"
#include "server/devices/head.hpp"

namespace sonard::server {

/// Joins the pure gemini::Device with a socket, a timer, the pose history and the render thread. It decides
/// nothing about the protocol. While the socket is full the device stands still: nothing is dropped, and the
/// pacing takes up again when the socket drains.
class GeminiHead final : public Head {
 public:
  /// Boots the head and binds its sockets.
  /// @param stream number of this head among the users of the renderer
  /// @throws SocketError
  GeminiHead(const GeminiHeadConfig& config, int stream, const HeadServices& services);
  ~GeminiHead() override;

  void start() override;
  void stop() override;
  void poses_changed() override;
  std::optional<std::chrono::nanoseconds> spare_poses() const override;

  GeminiHeadCounters counters() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
