// SPDX-License-Identifier: Apache-2.0
// Ends of a scan's turns, also if pings are lost.
#include "clients/sonarview/ping360/sweeps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace sonard::client {
namespace {

using testing::ElementsAre;

/// Number of pings in each turn that ends within these angles.
std::vector<std::size_t> turns(bool all_round, const std::vector<int>& angles) {
  SweepCollector collector(all_round);
  std::vector<std::size_t> sizes;
  for (const int angle : angles) {
    ping360::ReceivedPing ping;
    ping.form.settings.angle = static_cast<std::uint16_t>(angle);
    if (const auto done = collector.add(ping)) {
      EXPECT_EQ(done->number, sizes.size());
      sizes.push_back(done->lines.size());
    }
  }
  return sizes;
}

std::vector<int> all_round(int step, int turns, int first = 0) {
  std::vector<int> angles;
  for (int way = 0; way < 400 * turns; way += step) {
    angles.push_back((first + way) % 400);
  }
  return angles;
}

TEST(Ping360Sweeps, ATurnEndsWhereTheHeadHasComeRound) {
  EXPECT_THAT(turns(true, all_round(1, 3)), ElementsAre(400, 400));
  EXPECT_THAT(turns(true, all_round(10, 3, 395)), ElementsAre(40, 40));
}

TEST(Ping360Sweeps, ALostPingCostsTheTurnOnePing) {
  std::vector<int> angles = all_round(10, 3);
  angles.erase(angles.begin() + 20);
  EXPECT_THAT(turns(true, angles), ElementsAre(39, 40));
  angles.erase(angles.begin() + 39);  // the first of the second turn, which then begins and ends a ping later
  EXPECT_THAT(turns(true, angles), ElementsAre(39, 40));
}

TEST(Ping360Sweeps, ASectorEndsWhereTheHeadTurnsBack) {
  EXPECT_THAT(turns(false, {390, 395, 0, 5, 10, 5, 0, 395, 390, 395, 0}), ElementsAre(5, 4));
}

}  // namespace
}  // namespace sonard::client
