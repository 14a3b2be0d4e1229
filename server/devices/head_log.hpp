// SPDX-License-Identifier: Apache-2.0
// The log lines of one head.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "protocol/common/device.hpp"
#include "server/devices/head_rendering.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {

/// All counts of a head at one moment.
struct HeadCounts {
  RenderCounters rendering;
  PingProgress pings;
  std::vector<Counter> device;
  std::vector<Counter> transport;
};

/// Logs changes since the last call, at level info and above.
class HeadLog {
 public:
  explicit HeadLog(std::string head) : head_(std::move(head)) {}

  void notice(const Notice& notice);
  /// Logs a ping that is about to be rendered.
  void ping(const PingJob& job, bool turns, const render::Pose& T_world_sonar);
  /// Logs rates; call it every `period`. Silent if nothing happened in the period.
  void rates(const HeadCounts& total, std::chrono::duration<double> period);
  /// Call it once, at the end.
  void totals(const HeadCounts& total) const;

 private:
  void settings(const PingJob& job);
  void warn_of(const std::vector<Counter>& before, const std::vector<Counter>& now) const;

  std::string head_;
  PeerLog notices_, setting_changes_;  // limited: a client can cause any number of lines
  std::vector<Setting> settings_;      ///< as last logged
  HeadCounts reported_;
};

}  // namespace sonard::server
