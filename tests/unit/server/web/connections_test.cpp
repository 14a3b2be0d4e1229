// SPDX-License-Identifier: Apache-2.0
// Connections of the page that are kept, refused or closed.
#include "server/web/connections.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

constexpr std::uint32_t attacker = 0x0A000001, monitor = 0x0A000002;

TEST(Connections, ViewersAreLimitedForEachPeerAndInAll) {
  Connections connections(5, 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(connections.add_viewer(attacker), "");
  }
  EXPECT_EQ(connections.add_viewer(attacker),
            "Too many viewers from this address: 3 are connected, the maximum (web.max_viewers_per_peer).");
  EXPECT_EQ(connections.add_viewer(monitor), "");
  EXPECT_EQ(connections.add_viewer(monitor), "");
  EXPECT_EQ(connections.add_viewer(monitor),
            "Too many viewers: 5 are connected, the maximum (web.max_viewers).");
  connections.remove_viewer(attacker);
  EXPECT_EQ(connections.add_viewer(monitor), "");
}

TEST(Connections, ViewersTakeNoPlaceOfAMonitor) {
  Connections connections(1000, 1000);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(connections.add_viewer(attacker), "");
  }
  for (std::size_t i = 0; i < Connections::most_requests; ++i) {
    connections.enter(monitor, [] { FAIL() << "there was room"; });
  }
  EXPECT_EQ(connections.displaced(), 0U);
}

TEST(Connections, ThePeerWithTheMostLosesTheOneThatIsSilentLongest) {
  Connections connections(1, 1);
  std::vector<std::size_t> closed;
  const Connections::Place of_monitor =
      connections.enter(monitor, [] { FAIL() << "the monitor has but one"; });
  std::vector<Connections::Place> places;
  for (std::size_t i = 1; i < Connections::most_requests; ++i) {
    places.push_back(connections.enter(attacker, [&closed, i] { closed.push_back(i); }));
  }
  connections.used(places[0]);
  connections.enter(monitor, [] { FAIL() << "the monitor has but two"; });
  EXPECT_EQ(closed, std::vector<std::size_t>{2}) << "the first has just asked for something";
  connections.enter(attacker, [] { FAIL() << "it is the newest"; });
  EXPECT_EQ(closed, (std::vector<std::size_t>{2, 3}));
  connections.leave(of_monitor);
  connections.enter(attacker, [] { FAIL() << "there is a free place"; });
  EXPECT_EQ(connections.displaced(), 2U);
}

}  // namespace
}  // namespace sonard::server
