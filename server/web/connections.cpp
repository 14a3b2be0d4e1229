// SPDX-License-Identifier: Apache-2.0
#include "server/web/connections.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace sonard::server {

Connections::Place Connections::enter(std::uint32_t address, std::function<void()> close) {
  if (requests_.size() == most_requests) {
    displace_one();
  }
  return requests_.insert(requests_.end(), {address, std::move(close)});
}

void Connections::displace_one() {
  std::map<std::uint32_t, int> counts;
  for (const Request& request : requests_) {
    ++counts[request.address];
  }
  const int most = std::ranges::max_element(counts, {}, [](const auto& peer) { return peer.second; })->second;
  const auto displaced = std::ranges::find_if(
      requests_, [&](const Request& request) { return counts[request.address] == most; });
  const std::function<void()> close = std::move(displaced->close);
  requests_.erase(displaced);
  ++displaced_;
  close();
}

void Connections::used(Place place) {
  requests_.splice(requests_.end(), requests_, place);
}

void Connections::leave(Place place) {
  requests_.erase(place);
}

std::string Connections::add_viewer(std::uint32_t address) {
  if (viewers_ >= most_viewers_) {
    return fmt::format("Too many viewers: {} are connected, the maximum (web.max_viewers).", most_viewers_);
  }
  int& of_peer = viewers_of_peer_[address];
  if (of_peer >= most_viewers_per_peer_) {
    return fmt::format(
        "Too many viewers from this address: {} are connected, the maximum (web.max_viewers_per_peer).",
        of_peer);
  }
  ++of_peer;
  ++viewers_;
  return {};
}

void Connections::remove_viewer(std::uint32_t address) {
  --viewers_;
  if (const auto of_peer = viewers_of_peer_.find(address); --of_peer->second == 0) {
    viewers_of_peer_.erase(of_peer);
  }
}

}  // namespace sonard::server
