// What a user reads about a Micron: changes as they happen, rates now and then, never a line per packet.
// docs/your-micron-driver.md shows these lines.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "protocol/micron/device.hpp"
#include "server/devices/micron_head_counters.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {

/// Each function may be called as often as one likes: only what is new is logged, at level info and above.
class MicronHeadLog {
 public:
  MicronHeadLog(std::string head, const micron::DeviceConfig& config)
      : head_(std::move(head)), config_(config) {}

  /// `ready` after `scanning` is said when no line has been asked for in idle_after: between two lines of a
  /// scan some clients let a head be ready.
  void state(TimePoint now, micron::HeadState state);
  static constexpr std::chrono::seconds idle_after{2};
  /// A ping is about to be rendered with these settings.
  /// @param asked by the client; it does not matter to a ping that is played back
  void settings(const micron::MicronJob& job, const micron::HeadCommand& asked);
  /// Level debug, one line per ping.
  void ping(const micron::MicronJob& job, const HeadPing& ping) const;
  /// To be called every `period`; silent when nothing was asked of the head in it.
  void rates(const MicronHeadCounters& total, std::chrono::duration<double> period);
  /// Once, at the end.
  void totals(const MicronHeadCounters& total) const;

 private:
  std::string scan_text(const micron::HeadCommand& asked) const;
  void warn_of_settings(const micron::HeadCommand& asked);

  std::string head_;
  micron::DeviceConfig config_;
  PeerLog state_changes_, setting_changes_;
  std::optional<micron::HeadState> said_;
  std::optional<TimePoint> idle_since_;
  std::string settings_;  ///< as they were said last
  bool said_gain_ = false, said_limits_ = false, said_mirrored_ = false;
  MicronHeadCounters reported_;
};

}  // namespace sonard::server
