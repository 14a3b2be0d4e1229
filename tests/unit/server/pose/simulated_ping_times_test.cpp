// SPDX-License-Identifier: Apache-2.0
// Times of pings by the clock of a source, calculated by hand from the stamps.
#include "server/pose/simulated_ping_times.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <vector>

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr milliseconds period{100};
constexpr milliseconds listening{30};

PoseConfig by(PingClock clock) {
  PoseConfig config;
  config.clock = clock;
  return config;
}

struct SimulatedPingTimesTest : testing::Test {
  PoseHistory poses{by(PingClock::simulated_lock_step)};
  SimulatedPingTimes times{poses};
  TimePoint arrival{};

  SimulatedPingTimesTest() { spdlog::set_level(spdlog::level::off); }
  ~SimulatedPingTimesTest() override { spdlog::set_level(spdlog::level::info); }

  /// Inserts a pose. Arrival times must not matter, so poses arrive one minute apart.
  void pose(std::int64_t time_ms, double x_m = 0.0) {
    pose::PoseSample sample;
    sample.time_ns = time_ms * 1'000'000;
    sample.T_world_vehicle.position_m = {x_m, 0, 0};
    poses.insert(sample, arrival += std::chrono::minutes{1});
  }
  void poses_every(int step_ms, std::int64_t from_ms, std::int64_t to_ms) {
    for (std::int64_t time = from_ms; time <= to_ms; time += step_ms) {
      pose(time);
    }
  }
  /// Begins all pings that can begin now, and returns their times in ms.
  std::vector<std::int64_t> begun() {
    std::vector<std::int64_t> result;
    while (const auto time = times.begin(period, listening)) {
      result.push_back(*time / nanoseconds{milliseconds{1}});
    }
    return result;
  }
};

TEST_F(SimulatedPingTimesTest, NothingBeginsWithoutAPose) {
  EXPECT_THAT(begun(), IsEmpty());
}

TEST_F(SimulatedPingTimesTest, TheFirstIsAtAWholeNumberOfPeriods) {
  pose(1234);
  EXPECT_THAT(begun(), IsEmpty());
  poses_every(10, 1240, 1310);
  EXPECT_THAT(begun(), IsEmpty());
  pose(1329);
  EXPECT_THAT(begun(), IsEmpty()) << "1 ms of the last echo is still to come";
  pose(1330);
  EXPECT_THAT(begun(), ElementsAre(1300));
}

TEST_F(SimulatedPingTimesTest, StampsMayBeBeforeZero) {
  poses_every(10, -250, 40);
  EXPECT_THAT(begun(), IsEmpty()) << "who asks now wants what comes from now on";
  poses_every(10, 50, 240);
  EXPECT_THAT(begun(), ElementsAre(100, 200));
}

TEST_F(SimulatedPingTimesTest, LockStepMakesUpForAll) {
  pose(1000);
  EXPECT_THAT(begun(), IsEmpty());
  poses_every(10, 1010, 2000);
  EXPECT_THAT(begun(), ElementsAre(1000, 1100, 1200, 1300, 1400, 1500, 1600, 1700, 1800, 1900));
  EXPECT_EQ(times.counters().left_out, 0U);
}

TEST_F(SimulatedPingTimesTest, WithoutLockStepWhatIsLateIsLeftOut) {
  poses = PoseHistory{by(PingClock::simulated)};
  pose(1000);
  EXPECT_THAT(begun(), IsEmpty());
  poses_every(10, 1010, 2029);
  EXPECT_THAT(begun(), ElementsAre(1900)) << "the echoes of the one at 2000 are not all there";
  EXPECT_EQ(times.counters().left_out, 9U);
  pose(2030);
  EXPECT_THAT(begun(), ElementsAre(2000));
}

TEST_F(SimulatedPingTimesTest, APausedSourceHasNoPings) {
  pose(1000);
  begun();
  poses_every(10, 1010, 1050);
  EXPECT_THAT(begun(), ElementsAre(1000));
  for (int again = 0; again < 100; ++again) {
    pose(1050);
  }
  EXPECT_THAT(begun(), IsEmpty());
  poses_every(10, 1060, 1130);
  EXPECT_THAT(begun(), ElementsAre(1100)) << "as if there had been no pause";
}

TEST_F(SimulatedPingTimesTest, AResetBeginsAnew) {
  pose(5000);
  begun();
  poses_every(10, 5010, 5150);
  EXPECT_THAT(begun(), ElementsAre(5000, 5100));
  pose(20);
  EXPECT_THAT(begun(), IsEmpty());
  poses_every(10, 30, 250);
  EXPECT_THAT(begun(), ElementsAre(100, 200));
}

TEST_F(SimulatedPingTimesTest, TheFirstOfANewLifeIsThatOfItsFirstStampHoweverLateItIsAskedFor) {
  pose(0);
  EXPECT_THAT(begun(), IsEmpty());
  poses_every(10, 10, 340);
  EXPECT_THAT(begun(), ElementsAre(0, 100, 200, 300));
  poses_every(10, 40, 540);  // while the head is busy with the ping at 300
  EXPECT_EQ(times.lead(), milliseconds(540 - 30 - 100));
  EXPECT_THAT(begun(), ElementsAre(100, 200, 300, 400, 500));
}

TEST_F(SimulatedPingTimesTest, NoPingIsInAGapOfTheSource) {
  pose(1000);
  begun();
  poses_every(10, 1010, 1150);
  EXPECT_THAT(begun(), ElementsAre(1000, 1100));
  pose(100'004);  // poses in between are unknown
  poses_every(10, 100'010, 100'250);
  EXPECT_THAT(begun(), ElementsAre(100'100, 100'200));
  EXPECT_EQ(times.counters().unknown, 989U);
}

TEST_F(SimulatedPingTimesTest, WhoRestsAndWantsAgainBeginsNow) {
  pose(1000);
  begun();
  poses_every(10, 1010, 1150);
  EXPECT_THAT(begun(), ElementsAre(1000, 1100));
  times.rest();
  poses_every(10, 1165, 3005);
  EXPECT_THAT(begun(), IsEmpty());
  poses_every(10, 3010, 3150);
  EXPECT_THAT(begun(), ElementsAre(3100));
}

TEST_F(SimulatedPingTimesTest, TellsWhatPosesThereAreToSpare) {
  EXPECT_FALSE(times.lead());
  pose(1000);
  EXPECT_FALSE(times.lead()) << "nobody has asked";
  begun();
  EXPECT_EQ(times.lead(), -listening);
  poses_every(10, 1010, 1500);
  EXPECT_EQ(times.lead(), milliseconds{470}) << "the ping at 1000 listens to 1030";
  ASSERT_TRUE(times.begin(period, listening));
  ASSERT_TRUE(times.begin(period, listening));
  EXPECT_EQ(times.lead(), milliseconds{270}) << "the next one is at 1200";
  pose(0);
  EXPECT_EQ(times.lead(), -listening) << "that ping will not be; the first of the new life is at 0";
  times.rest();
  EXPECT_FALSE(times.lead());
}

TEST_F(SimulatedPingTimesTest, PosesThatAreNoLongerKeptAreSaid) {
  pose(0);
  begun();
  poses_every(1, 1, 10'000);
  const auto all = begun();
  // 4096 poses are kept, and the oldest is at 5905 ms.
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.front(), 6000);
  EXPECT_EQ(times.counters().lost, 60U);
}

TEST_F(SimulatedPingTimesTest, ThePoseOfAPingIsThatOfItsStampWheneverItCame) {
  pose(1000, 10.0);
  begun();
  pose(1090, 19.0);
  pose(1140, 24.0);
  const auto first = times.begin(period, listening);
  const auto second = times.begin(period, listening);
  ASSERT_TRUE(first && second);
  EXPECT_DOUBLE_EQ(poses.at(*first)->T_world_vehicle.position_m.x, 10.0);
  EXPECT_NEAR(poses.at(*second)->T_world_vehicle.position_m.x, 20.0, 1e-12);
  EXPECT_EQ(poses.stamp_at(*second), 1'100'000'000);
}

}  // namespace
}  // namespace sonard::server
