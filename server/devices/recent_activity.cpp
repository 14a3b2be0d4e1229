// SPDX-License-Identifier: Apache-2.0
#include "server/devices/recent_activity.hpp"

#include <algorithm>

namespace sonard::server {

void RecentClients::sent(const Endpoint& from, TimePoint now) {
  auto client = std::find_if(clients_.begin(), clients_.end(),
                             [&](const ClientSeen& seen) { return seen.address == from; });
  if (client == clients_.end()) {
    if (clients_.size() == most) {
      clients_.pop_back();
    }
    client = clients_.insert(clients_.end(), ClientSeen{.address = from});
  }
  client->last = now;
  ++client->pieces;
  std::rotate(clients_.begin(), client, client + 1);
}

void RecentClients::gone(const Endpoint& who) {
  std::erase_if(clients_, [&](const ClientSeen& seen) { return seen.address == who; });
}

std::vector<ClientSeen> RecentClients::since(TimePoint from) const {
  std::vector<ClientSeen> recent = clients_;
  std::erase_if(recent, [from](const ClientSeen& seen) { return seen.last < from; });
  return recent;
}

void RecentPings::sent(TimePoint now, TimePoint transmit_time) {
  times_.push_back(now);
  while (now - times_.front() > period) {
    times_.pop_front();
  }
  latency_ = now - transmit_time;
}

std::optional<std::chrono::nanoseconds> RecentPings::silence(TimePoint now) const {
  return times_.empty() ? std::nullopt : std::optional<std::chrono::nanoseconds>(now - times_.back());
}

double RecentPings::per_s(TimePoint now) const {
  const auto first =
      std::find_if(times_.begin(), times_.end(), [now](TimePoint time) { return now - time <= period; });
  const auto count = times_.end() - first;
  if (count < 2) {
    return 0.0;
  }
  // The mean interval between pings of the period: one interval fewer than pings. If the time since the
  // newest ping is longer than that, it counts instead.
  const std::chrono::duration<double> between = times_.back() - *first;
  const double interval = between.count() / static_cast<double>(count - 1);
  const std::chrono::duration<double> silence = now - times_.back();
  return 1.0 / std::max(interval, silence.count());
}

}  // namespace sonard::server
