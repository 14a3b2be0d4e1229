// SPDX-License-Identifier: Apache-2.0
// The lines of one head in the program's log.
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

/// Logs what is new since the last call, at level info and above, however often it is called.
class HeadLog {
 public:
  explicit HeadLog(std::string head) : head_(std::move(head)) {}

  void notice(const Notice& notice);
  /// A ping is about to be rendered.
  void ping(const PingJob& job, bool scanning, const render::Pose& T_world_sonar);
  /// To be called every `period`; silent when nothing was done in it.
  void rates(const HeadCounts& total, std::chrono::duration<double> period);
  /// Once, at the end.
  void totals(const HeadCounts& total) const;

 private:
  void settings(const PingJob& job);
  void warn_of(const std::vector<Counter>& before, const std::vector<Counter>& now) const;

  std::string head_;
  PeerLog notices_, setting_changes_;  // limited: a client can cause any number
  std::vector<Setting> settings_;      ///< as they were logged last
  HeadCounts reported_;
};

}  // namespace sonard::server
