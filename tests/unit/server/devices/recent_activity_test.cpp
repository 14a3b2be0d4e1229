// SPDX-License-Identifier: Apache-2.0
// Recent activity of a head, at times set by hand.
#include "server/devices/recent_activity.hpp"

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(RecentPings, HaveTheRateOfEvenPings) {
  RecentPings pings;
  for (int i = 0; i < 100; ++i) {
    pings.sent(milliseconds{125 * i}, milliseconds{125 * i - 40});
  }
  EXPECT_DOUBLE_EQ(pings.per_s(milliseconds{125 * 99}), 8.0);
  EXPECT_EQ(pings.latency(), milliseconds{40});
}

TEST(RecentPings, AreNoneWhenTheyHaveStopped) {
  RecentPings pings;
  pings.sent(seconds{1}, seconds{1});
  pings.sent(seconds{2}, seconds{2});
  EXPECT_DOUBLE_EQ(pings.per_s(seconds{2}), 1.0);
  EXPECT_DOUBLE_EQ(pings.per_s(seconds{6}), 0.25);  // no ping for four seconds
  EXPECT_DOUBLE_EQ(pings.per_s(seconds{30}), 0.0);
}

TEST(RecentClients, ComeNewestFirstAndAreForgotten) {
  RecentClients clients;
  clients.sent({1, 1}, seconds{1});
  clients.sent({2, 2}, seconds{2});
  clients.sent({1, 1}, seconds{3});
  const auto all = clients.since(seconds{0});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].address, (Endpoint{1, 1}));
  EXPECT_EQ(all[0].pieces, 2U);
  EXPECT_EQ(clients.since(seconds{3}).size(), 1U);
  clients.gone({1, 1});
  EXPECT_EQ(clients.since(seconds{0}).size(), 1U);
}

TEST(RecentPings, KnowHowLongAgoTheNewestWas) {
  RecentPings pings;
  EXPECT_EQ(pings.silence(seconds{1}), std::nullopt);
  pings.sent(seconds{10}, seconds{9});
  pings.sent(seconds{12}, seconds{11});
  EXPECT_EQ(pings.silence(seconds{12}), seconds{0});
  EXPECT_EQ(pings.silence(seconds{3612}), seconds{3600});
}

TEST(RecentClients, TakeNoMoreMemoryForAPeerThatChangesItsPort) {
  RecentClients clients;
  for (std::uint16_t port = 1; port <= 1000; ++port) {
    clients.sent({1, port}, milliseconds{port});
  }
  const auto all = clients.since(seconds{0});
  ASSERT_EQ(all.size(), RecentClients::most);
  EXPECT_EQ(all[0].address.port, 1000);
}

}  // namespace
}  // namespace sonard::server
