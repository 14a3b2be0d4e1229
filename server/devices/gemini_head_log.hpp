// What a user reads about a head: changes as they happen, rates now and then, never a line per packet.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "protocol/gemini/ping_job.hpp"
#include "renderer/pose.hpp"
#include "server/config/config.hpp"
#include "server/devices/gemini_head_counters.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {

/// Each function may be called as often as one likes: only what is new is logged, at level info and above.
/// docs/your-driver.md shows these lines to users in the order in which they come.
class GeminiHeadLog {
 public:
  explicit GeminiHeadLog(std::string head) : head_(std::move(head)) {}

  /// The connected surface, 0 for none.
  void surface(Ipv4 address);
  /// A ping is about to be rendered with these settings.
  void settings(const gemini::PingJob& job);
  /// Level debug, one line per ping.
  void ping(const gemini::PingJob& job, std::uint64_t transmit_us, const render::Pose& T_world_sonar) const;
  /// A datagram came from an address that is not served.
  void stranger(Ipv4 address);
  /// To be called every `period`; silent when nothing was asked of the head in it.
  void rates(const GeminiHeadCounters& total, std::chrono::duration<double> period);
  /// Once, at the end.
  void totals(const GeminiHeadCounters& total) const;

 private:
  void log_faults(const char* direction, const FaultyLinkCounters& link) const;

  std::string head_;
  PeerLog surface_changes_, setting_changes_;
  Ipv4 surface_ = 0;
  std::optional<gemini::PingJob> settings_;
  std::set<Ipv4> strangers_;
  GeminiHeadCounters reported_;
};

}  // namespace sonard::server
