// SPDX-License-Identifier: Apache-2.0
// Recent pings and clients of a head, for its status.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "server/devices/head_status.hpp"

namespace sonard::server {

/// Clients that have sent something to a head. Belongs to the I/O thread.
class RecentClients {
 public:
  void sent(const Endpoint& from, TimePoint now);
  void gone(const Endpoint& who);
  /// Clients that sent something at `from` or later, newest first.
  std::vector<ClientSeen> since(TimePoint from) const;

  /// Limits memory: a peer may use a new port for each datagram.
  static constexpr std::size_t most = 16;

 private:
  std::vector<ClientSeen> clients_;  ///< newest first
};

/// Times at which a head's pings were sent. Belongs to the I/O thread.
class RecentPings {
 public:
  void sent(TimePoint now, TimePoint transmit_time);
  /// Mean rate in the last `period`, in pings per second; 0 if there were fewer than two pings.
  double per_s(TimePoint now) const;
  std::optional<std::chrono::nanoseconds> latency() const { return latency_; }
  /// Time since the newest ping; nullopt without a ping.
  std::optional<std::chrono::nanoseconds> silence(TimePoint now) const;

  static constexpr std::chrono::seconds period{5};

 private:
  std::deque<TimePoint> times_;  ///< in the last period before the newest ping, oldest first
  std::optional<std::chrono::nanoseconds> latency_;
};

}  // namespace sonard::server
