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

TEST(ReplaySchedule, the_first_ping_wanted_starts_the_clock) {
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

TEST(ReplaySchedule, speed_divides_all_offsets) {
  ReplaySchedule schedule({four}, {.speed = 2.0}, 0ns);
  play(schedule, 1s);
  EXPECT_EQ(play(schedule, 1s).second, 1050ms);
  EXPECT_EQ(play(schedule, 1s).second, 1125ms);
}

TEST(ReplaySchedule, a_little_late_is_caught_up) {
  ReplaySchedule schedule({four}, {}, 0ns);
  play(schedule, 0s);
  EXPECT_EQ(play(schedule, 180ms), (PlayedAt{1, 180ms}));
  EXPECT_EQ(play(schedule, 200ms), (PlayedAt{2, 250ms}));
  EXPECT_EQ(schedule.skipped(), 0U);
}

TEST(ReplaySchedule, the_clock_waits_for_a_client_that_was_away) {
  ReplaySchedule schedule({four}, {}, 0ns);
  play(schedule, 0s);
  EXPECT_EQ(play(schedule, 10s), (PlayedAt{1, 10s}));
  EXPECT_EQ(play(schedule, 10s), (PlayedAt{2, 10150ms}));
}

TEST(ReplaySchedule, as_asked_knows_no_times) {
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

TEST(ReplaySchedule, a_loop_goes_on_after_the_usual_interval) {
  // The intervals are 100, 150 and 50 ms, and their median is 100 ms.
  ReplaySchedule schedule({four}, {.loop = true}, 0ns);
  for (int i = 0; i < 4; ++i) {
    play(schedule, 0s);
  }
  EXPECT_EQ(play(schedule, 0s), (PlayedAt{0, 400ms}));
  EXPECT_EQ(play(schedule, 0s), (PlayedAt{1, 500ms}));
  EXPECT_FALSE(schedule.over(1h));
}

TEST(ReplaySchedule, heads_keep_in_step) {
  const std::vector<std::int64_t> later{1150 * one_ms, 1350 * one_ms};
  ReplaySchedule schedule({four, later}, {}, 0ns);
  EXPECT_EQ(play(schedule, 5s, 1), (PlayedAt{0, 5s})) << "the first one wanted is that of the second head";
  EXPECT_EQ(schedule.next(0, 5s)->due, 4850ms);
  EXPECT_EQ(play(schedule, 5s, 1).second, 5200ms);
  EXPECT_FALSE(schedule.over(5s));
}

TEST(ReplaySchedule, a_clock_that_runs_from_the_start_skips_what_nobody_wants_in_time) {
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

TEST(ReplaySchedule, one_ping_alone_can_be_looped) {
  ReplaySchedule schedule({{5 * one_ms}}, {.loop = true}, 0ns);
  play(schedule, 0s);
  EXPECT_EQ(play(schedule, 0s), (PlayedAt{0, 1s}));
}

TEST(ReplaySchedule, a_loop_of_pings_without_times_gets_on) {
  ReplaySchedule schedule({{5 * one_ms, 5 * one_ms}}, {.loop = true, .start_now = true}, 0ns);
  EXPECT_TRUE(schedule.next(0, 10s));
}

}  // namespace
}  // namespace sonard::server
