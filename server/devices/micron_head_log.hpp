// What a user reads about a Micron: changes as they happen, rates now and then, never a line per packet.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "protocol/micron/device.hpp"
#include "server/devices/micron_head_counters.hpp"

namespace sonard::server {

/// Each function may be called as often as one likes: only what is new is logged, at level info and above.
class MicronHeadLog {
 public:
  explicit MicronHeadLog(std::string head) : head_(std::move(head)) {}

  void state(micron::HeadState state);
  /// A ping is about to be rendered with these settings.
  void settings(const micron::MicronJob& job);
  /// Level debug, one line per ping.
  void ping(const micron::MicronJob& job, const HeadPing& ping) const;
  /// To be called every `period`; silent when nothing was asked of the head in it.
  void rates(const MicronHeadCounters& total, std::chrono::duration<double> period);
  /// Once, at the end.
  void totals(const MicronHeadCounters& total) const;

 private:
  std::string head_;
  std::optional<micron::HeadState> state_;
  std::optional<micron::MicronJob> settings_;
  MicronHeadCounters reported_;
};

}  // namespace sonard::server
