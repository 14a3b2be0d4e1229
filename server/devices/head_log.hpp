// SPDX-License-Identifier: Apache-2.0
// What a head says of itself in the log of the program.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "protocol/common/device.hpp"
#include "server/devices/head_rendering.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {

/// What there is to count of a head at one moment.
struct HeadCounts {
  RenderCounters rendering;
  PingProgress pings;
  std::vector<Counter> device;
  std::vector<Counter> transport;
};

/// Each function may be called as often as one likes: only what is new is logged, at level info and above.
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
  PeerLog notices_, setting_changes_;  // a client may cause them as often as it likes
  std::vector<Setting> settings_;      ///< as they were said last
  HeadCounts reported_;
};

}  // namespace sonard::server
