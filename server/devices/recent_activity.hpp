// SPDX-License-Identifier: Apache-2.0
// What a head did lately, and who asked it to, for its status.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "server/devices/head_status.hpp"

namespace sonard::server {

/// Who has sent something to a head. Belongs to the I/O thread.
class RecentClients {
 public:
  void sent(const Endpoint& from, TimePoint now);
  void gone(const Endpoint& who);
  /// Those that sent something at `from` or later, the newest first.
  std::vector<ClientSeen> since(TimePoint from) const;

  /// A peer that changes its port with each datagram takes no more memory than this.
  static constexpr std::size_t most = 16;

 private:
  std::vector<ClientSeen> clients_;  ///< the newest first
};

/// When a head's pings went out. Belongs to the I/O thread.
class RecentPings {
 public:
  void sent(TimePoint now, TimePoint transmit_time);
  /// Mean rate of the last `period`, or since the first ping where that is later.
  double per_s(TimePoint now) const;
  std::optional<std::chrono::nanoseconds> latency() const { return latency_; }
  /// Time since the newest ping; nullopt without one.
  std::optional<std::chrono::nanoseconds> silence(TimePoint now) const;

  static constexpr std::chrono::seconds period{5};

 private:
  std::deque<TimePoint> times_;  ///< of the last period before the newest ping, the oldest first
  std::optional<std::chrono::nanoseconds> latency_;
};

}  // namespace sonard::server
