// SPDX-License-Identifier: Apache-2.0
// Where a head shows its pings to people who watch.
#pragma once

#include <memory>
#include <optional>

#include "protocol/common/ping_record.hpp"
#include "renderer/pose.hpp"
#include "server/clock/clock.hpp"

namespace sonard::server {

/// A ping that has gone out, for people.
struct ShownPing {
  int head = 0;      ///< its place in the configuration
  TimePoint time{};  ///< when it went out, on the clock of the daemon
  PingRecord record;
  std::optional<render::Pose> T_world_mount;  ///< of the head when the ping was sent; nullopt: not known
};

/// Called on the I/O thread; must not wait.
class PingViewer {
 public:
  PingViewer() = default;
  virtual ~PingViewer() = default;
  PingViewer(const PingViewer&) = delete;
  PingViewer& operator=(const PingViewer&) = delete;

  /// Takes each ping that goes out, whether anybody watches or not: the next viewer begins with the newest.
  virtual void show(std::shared_ptr<const ShownPing> ping) = 0;
};

}  // namespace sonard::server
