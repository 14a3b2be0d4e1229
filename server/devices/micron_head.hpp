// A simulated Micron on its serial line.
#pragma once

#include <memory>

#include "server/config/config.hpp"
#include "server/devices/head.hpp"
#include "server/devices/micron_head_counters.hpp"

namespace sonard::server {

/// Joins the pure micron::Device with a serial line, a timer, the pose history and the render thread. It
/// decides nothing about the protocol. The head runs whether anybody listens or not, as a real one does.
class MicronHead final : public Head {
 public:
  /// Powers the head up and opens its line.
  /// @param stream number of this head among the users of the renderer
  /// @throws SocketError naming the address or path
  MicronHead(const MicronHeadConfig& config, int stream, const HeadServices& services);
  ~MicronHead() override;

  void start() override;
  void stop() override;
  void poses_changed() override;
  std::optional<std::chrono::nanoseconds> spare_poses() const override;

  MicronHeadCounters counters() const;
  /// Where its clients reach it.
  SerialAddresses addresses() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
