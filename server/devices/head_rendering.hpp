// SPDX-License-Identifier: Apache-2.0
// The rendering of a head's pings, with counts and log lines.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "renderer/ping.hpp"
#include "renderer/skip_ledger.hpp"
#include "server/clock/clock.hpp"
#include "server/devices/render_load.hpp"
#include "server/heads/head_config.hpp"
#include "server/program_log/peer_log.hpp"
#include "server/rendering/render_service.hpp"

namespace sonard::server {

/// Counters; they only grow.
struct RenderCounters {
  std::uint64_t pings_without_pose = 0;  ///< not rendered: no pose, or a stale one under StalePolicy::silence
  std::uint64_t pings_rendered = 0;
  double render_seconds = 0.0;  ///< all stages except multipath
  render::StageSeconds stages;
  render::SkipCounts skipped;  ///< of all pings
};

/// Belongs to the I/O thread.
class HeadRendering {
 public:
  struct Options {
    bool adapts = true;     ///< chooses the preset by RenderLoad; false: an image depends on its ping alone
    bool withdraws = true;  ///< SkipRule::nobody_listening
  };

  /// @param config, renderer, clock must outlive this object
  /// @param head index of the head
  HeadRendering(const HeadConfig& config, int head, RenderService& renderer, const Clock& clock,
                const Options& options);

  /// @param period PingJob::period
  void submit(PosedPing ping, std::chrono::nanoseconds period, RenderService::Done done);
  /// Counts an answer and logs its error, once per error. @return true if there are samples
  bool take(const RenderResult& result);
  /// Withdraws a ping that waits behind pings of other heads.
  bool withdraw();
  void count_missing_pose() { ++counters_.pings_without_pose; }

  /// True if a ping was submitted and is not answered yet.
  bool busy() const { return submitted_; }
  const RenderCounters& counters() const { return counters_; }
  const render::StageSeconds& newest_seconds() const { return newest_; }

 private:
  const HeadConfig& config_;
  const int head_;
  RenderService& renderer_;
  const Clock& clock_;
  const Options options_;
  bool submitted_ = false;
  RenderLoad load_;
  RenderCounters counters_;
  render::StageSeconds newest_;  ///< of the newest ping
  std::string last_error_;
  PeerLog errors_;
};

/// Logs "head=NAME: skipped rule=count ..." at level debug, with every rule that has skipped something.
void log_skipped(const std::string& head, const render::SkipCounts& skipped);
/// Mean rendering time of a ping between two states of the counters, in milliseconds; 0 if there was no ping.
double mean_render_ms(const RenderCounters& before, const RenderCounters& now);

}  // namespace sonard::server
