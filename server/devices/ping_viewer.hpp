// SPDX-License-Identifier: Apache-2.0
// Interface through which a head shows its pings to viewers.
#pragma once

#include <memory>
#include <optional>

#include "protocol/common/ping_record.hpp"
#include "renderer/pose.hpp"
#include "server/clock/clock.hpp"

namespace sonard::server {

/// A ping that was sent, for viewers.
struct ShownPing {
  int head = 0;      ///< index in the configuration
  TimePoint time{};  ///< when it was sent, on the clock of the daemon
  PingRecord record;
  std::optional<render::Pose> T_world_mount;  ///< at the time of transmission; nullopt: not known
};

/// Called on the I/O thread; must not wait.
class PingViewer {
 public:
  PingViewer() = default;
  virtual ~PingViewer() = default;
  PingViewer(const PingViewer&) = delete;
  PingViewer& operator=(const PingViewer&) = delete;

  /// Takes each sent ping, even if there is no viewer: the next viewer starts with the newest ping.
  virtual void show(std::shared_ptr<const ShownPing> ping) = 0;
};

}  // namespace sonard::server
