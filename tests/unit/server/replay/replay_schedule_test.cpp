// SPDX-License-Identifier: Apache-2.0
// Due times of recorded pings, against times calculated by hand.
#include "server/replay/replay_schedule.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t one_ms = 1'000'000;
const std::vector<std::int64_t> four{1000 * one_ms, 1100 * one_ms, 1250 * one_ms, 1300 * one_ms};

/// Starts the next ping of a head when it is due, but not before `wanted_at`. Returns its image and time.
std::pair<std::size_t, TimePoint> play(ReplaySchedule& schedule, TimePoint wanted_at, std::size_t head = 0) {
  const auto ping = schedule.next(head, wanted_at);
  if (!ping) {
    ADD_FAILURE() << "nothing is left";
    return {};
  }
  const TimePoint at = std::max(wanted_at, ping->due.value_or(wanted_at));
  schedule.started(head, at);
  return {ping->image, at};
}

using PlayedAt = std::pair<std::size_t, TimePoint>;

TEST(ReplaySchedule, TheFirstPingWantedStartsTheClock) {
  ReplaySchedule schedule({four}, {}, 0ns);
  EXPECT_EQ(schedule.next(0, 7s)->due, std::nullopt);
  EXPECT_EQ(play(schedule, 7s), (PlayedAt{0, 7s}));
  EXPECT_EQ(play(schedule, 7s), (PlayedAt{1, 7100ms}));
  EXPECT_EQ(play(schedule, 7150ms), (PlayedAt{2, 7250ms}));
  EXPECT_FALSE(schedule.over(8s));
  EXPECT_EQ(play(schedule, 7s), (PlayedAt{3, 7300ms}));
  EXPECT_TRUE(schedule.over(7300ms));
  EXPECT_FALSE(schedule.next(0, 8s));
}

TEST(ReplaySchedule, SpeedDividesAllOffsets) {
  ReplaySchedule schedule({four}, {.speed = 2.0}, 0ns);
  play(schedule, 1s);
  EXPECT_EQ(play(schedule, 1s).second, 1050ms);
  EXPECT_EQ(play(schedule, 1s).second, 1125ms);
}

TEST(ReplaySchedule, ALittleLateIsCaughtUp) {
  ReplaySchedule schedule({four}, {}, 0ns);
  play(schedule, 0s);
  EXPECT_EQ(play(schedule, 180ms), (PlayedAt{1, 180ms}));
  EXPECT_EQ(play(schedule, 200ms), (PlayedAt{2, 250ms}));
  EXPECT_EQ(schedule.skipped(), 0U);
}

TEST(ReplaySchedule, TheClockWaitsForAClientThatWasAway) {
  ReplaySchedule schedule({four}, {}, 0ns);
  play(schedule, 0s);
  EXPECT_EQ(play(schedule, 10s), (PlayedAt{1, 10s}));
  EXPECT_EQ(play(schedule, 10s), (PlayedAt{2, 10150ms}));
}

TEST(ReplaySchedule, AsAskedKnowsNoTimes) {
  ReplaySchedule schedule({four}, {.as_asked = true}, 0ns);
  for (std::size_t image = 0; image < 4; ++image) {
    const auto ping = schedule.next(0, 1s);
    ASSERT_TRUE(ping);
    EXPECT_EQ(ping->image, image);
    EXPECT_EQ(ping->due, std::nullopt);
    schedule.started(0, 1s);
  }
  EXPECT_TRUE(schedule.over(1s));
}

TEST(ReplaySchedule, ALoopGoesOnAfterTheUsualInterval) {
  // The intervals are 100, 150 and 50 ms, and their median is 100 ms.
  ReplaySchedule schedule({four}, {.loop = true}, 0ns);
  for (int i = 0; i < 4; ++i) {
    play(schedule, 0s);
  }
  EXPECT_EQ(play(schedule, 0s), (PlayedAt{0, 400ms}));
  EXPECT_EQ(play(schedule, 0s), (PlayedAt{1, 500ms}));
  EXPECT_FALSE(schedule.over(1h));
}

TEST(ReplaySchedule, HeadsKeepInStep) {
  const std::vector<std::int64_t> later{1150 * one_ms, 1350 * one_ms};
  ReplaySchedule schedule({four, later}, {}, 0ns);
  EXPECT_EQ(play(schedule, 5s, 1), (PlayedAt{0, 5s})) << "the first one wanted is that of the second head";
  EXPECT_EQ(schedule.next(0, 5s)->due, 4850ms);
  EXPECT_EQ(play(schedule, 5s, 1).second, 5200ms);
  EXPECT_FALSE(schedule.over(5s));
}

TEST(ReplaySchedule, AClockThatRunsFromTheStartSkipsWhatNobodyWantsInTime) {
  ReplaySchedule schedule({four}, {.start_now = true}, 2s);
  EXPECT_EQ(schedule.next(0, 2s)->due, 2s);
  EXPECT_EQ(schedule.next(0, 2099ms)->image, 0U);
  EXPECT_EQ(play(schedule, 2260ms), (PlayedAt{2, 2260ms}));
  EXPECT_EQ(schedule.skipped(), 2U);
  EXPECT_EQ(schedule.next(0, 3300ms)->image, 3U);
  EXPECT_FALSE(schedule.next(0, 3301ms)) << "a second after its time it is too late";
  EXPECT_TRUE(schedule.over(3301ms));
  EXPECT_EQ(schedule.skipped(), 3U);
}

TEST(ReplaySchedule, OnePingAloneCanBeLooped) {
  ReplaySchedule schedule({{5 * one_ms}}, {.loop = true}, 0ns);
  play(schedule, 0s);
  EXPECT_EQ(play(schedule, 0s), (PlayedAt{0, 1s}));
}

TEST(ReplaySchedule, ALoopOfPingsWithoutTimesGetsOn) {
  ReplaySchedule schedule({{5 * one_ms, 5 * one_ms}}, {.loop = true, .start_now = true}, 0ns);
  EXPECT_TRUE(schedule.next(0, 10s));
}

}  // namespace
}  // namespace sonard::server
