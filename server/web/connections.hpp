// SPDX-License-Identifier: Apache-2.0
// Limits the connections to the page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <string>

namespace sonard::server {

/// Decides which connections are kept. Requests and viewers (WebSockets) have separate limits, so that
/// viewers leave room for monitors. A peer is an IPv4 address, in host byte order. Belongs to the page's
/// thread.
class Connections {
  struct Request {
    std::uint32_t address = 0;
    std::function<void()> close;
  };

 public:
  using Place = std::list<Request>::iterator;

  Connections(int most_viewers, int most_viewers_per_peer)
      : most_viewers_(most_viewers), most_viewers_per_peer_(most_viewers_per_peer) {}

  /// Gives an HTTP connection a place. If all places are taken, the peer with the most places loses the
  /// connection whose last request is oldest.
  /// @param close closes the connection; called when it loses its place
  /// @return valid until leave() or `close`
  Place enter(std::uint32_t address, std::function<void()> close);
  /// Call it for each request of a connection.
  void used(Place place);
  void leave(Place place);
  /// Number of connections that lost their places.
  std::uint64_t displaced() const { return displaced_; }

  /// Gives a viewer a place until remove_viewer(). @return why it gets no place; empty: it has one
  std::string add_viewer(std::uint32_t address);
  void remove_viewer(std::uint32_t address);

  static constexpr std::size_t most_requests = 128;

 private:
  void displace_one();

  int most_viewers_;
  int most_viewers_per_peer_;
  std::list<Request> requests_;  ///< by the time of their last request, oldest first
  int viewers_ = 0;
  std::map<std::uint32_t, int> viewers_of_peer_;
  std::uint64_t displaced_ = 0;
};

}  // namespace sonard::server
