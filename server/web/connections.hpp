// SPDX-License-Identifier: Apache-2.0
// Places of the connections to the page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <string>

namespace sonard::server {

/// Decides which connections are kept. Requests and viewers (WebSockets) have separate places, so that
/// viewers leave room for monitors. A peer is an IPv4 address, in the host's byte order. Belongs to the
/// thread of the page.
class Connections {
  struct Request {
    std::uint32_t address = 0;
    std::function<void()> close;
  };

 public:
  using Place = std::list<Request>::iterator;

  Connections(int most_viewers, int most_viewers_per_peer)
      : most_viewers_(most_viewers), most_viewers_per_peer_(most_viewers_per_peer) {}

  /// Gives a connection of HTTP its place. If all places are taken, the peer with the most of them loses the
  /// connection whose last request is oldest.
  /// @param close ends the connection; called when it has lost its place
  /// @return valid until leave() or `close`
  Place enter(std::uint32_t address, std::function<void()> close);
  /// A request has come by this connection.
  void used(Place place);
  void leave(Place place);
  /// How many connections have lost their places.
  std::uint64_t displaced() const { return displaced_; }

  /// Gives a viewer a place until remove_viewer(). @return why it gets none; empty: it has one
  std::string add_viewer(std::uint32_t address);
  void remove_viewer(std::uint32_t address);

  static constexpr std::size_t most_requests = 128;

 private:
  void displace_one();

  int most_viewers_;
  int most_viewers_per_peer_;
  std::list<Request> requests_;  ///< the one whose last request is oldest comes first
  int viewers_ = 0;
  std::map<std::uint32_t, int> viewers_of_peer_;
  std::uint64_t displaced_ = 0;
};

}  // namespace sonard::server
