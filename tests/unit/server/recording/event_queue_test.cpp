// SPDX-License-Identifier: Apache-2.0
#include "server/recording/event_queue.hpp"

#include <thread>

#include <gtest/gtest.h>

#include "tests/unit/server/recording/fixture.hpp"

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using test::ping_event;
using test::wire_event;

TEST(EventQueue, GivesEventsInTheirOrderAndOnce) {
  EventQueue queue(1 << 20);
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(queue.push(wire_event(10, TimePoint{i})));
  }
  const std::vector<RecordingEvent> events = queue.take();
  ASSERT_EQ(events.size(), 100U);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(events[static_cast<std::size_t>(i)].time, TimePoint{i});
  }
  EXPECT_TRUE(queue.take().empty());
}

TEST(EventQueue, HoldsNoMoreBytesThanItMay) {
  constexpr std::size_t most = 100'000;
  EventQueue queue(most);
  std::size_t held = 0;
  while (queue.push(wire_event(1000, {}))) {
    held += 1000;
  }
  EXPECT_LE(held, most);
  EXPECT_GT(held, most / 2);  // an event's description counts too
}

TEST(EventQueue, CountsWhatItDropsByWhatIsLost) {
  EventQueue queue(3000);
  EXPECT_TRUE(queue.push(wire_event(2000, {})));
  EXPECT_FALSE(queue.push(ping_event(1, 32, {})));
  EXPECT_FALSE(queue.push(ping_event(2, 32, {})));
  RecordingEvent two_datagrams = wire_event(2000, {});
  auto& pieces = std::get<WirePassed>(two_datagrams.what).pieces;
  pieces.push_back(pieces.front());
  EXPECT_FALSE(queue.push(two_datagrams));
  const SharedBytes status(std::vector<std::uint8_t>(1500));
  EXPECT_FALSE(queue.push({0, {}, StatusSent{status}}));
  EXPECT_EQ(queue.dropped().images, 2U);
  EXPECT_EQ(queue.dropped().pieces, 2U);
  EXPECT_EQ(queue.dropped().others, 1U);
  EXPECT_EQ(queue.dropped().total(), 5U);
  EXPECT_EQ(queue.take().size(), 1U);
}

TEST(EventQueue, HasRoomAgainWhenEventsAreWorkedOffNotWhenTheyAreTaken) {
  EventQueue queue(3000);
  ASSERT_TRUE(queue.push(wire_event(2000, {})));
  const std::vector<RecordingEvent> events = queue.take();
  EXPECT_FALSE(queue.push(wire_event(2000, {})));
  queue.done(events.front());
  EXPECT_TRUE(queue.push(wire_event(2000, {})));
}

TEST(EventQueue, CountsAllBytesOfAPing) {
  // 256 samples per line, and 256 bearings.
  EXPECT_GE(memory_of(ping_event(1, 1000, {})), 258'000U);
  EXPECT_LE(memory_of(ping_event(1, 1000, {})), 262'000U);
}

TEST(EventQueue, WakesWhoeverWaits) {
  EventQueue queue(1 << 20);
  const auto begin = std::chrono::steady_clock::now();
  std::thread pusher([&] {
    std::this_thread::sleep_for(milliseconds{20});
    queue.push(wire_event(1, {}));
  });
  queue.wait(milliseconds{20'000});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, milliseconds{10'000});
  pusher.join();
  EXPECT_EQ(queue.take().size(), 1U);
}

// The thread sanitizer would report a race in this test.
TEST(EventQueue, TakesFromSeveralThreadsAtOnce) {
  constexpr int threads = 3;
  constexpr int each = 2000;
  EventQueue queue(std::size_t{1} << 30);
  std::vector<std::thread> pushers;
  for (int thread = 0; thread < threads; ++thread) {
    pushers.emplace_back([&queue, thread] {
      for (int i = 0; i < each; ++i) {
        RecordingEvent event = wire_event(1, TimePoint{i});
        event.head = thread;
        queue.push(std::move(event));
      }
    });
  }
  std::vector<TimePoint> next(threads, TimePoint{0});
  int seen = 0;
  while (seen < threads * each) {
    queue.wait(milliseconds{1000});
    for (const RecordingEvent& event : queue.take()) {
      EXPECT_EQ(event.time, next[static_cast<std::size_t>(event.head)]++);
      queue.done(event);
      ++seen;
    }
  }
  for (std::thread& pusher : pushers) {
    pusher.join();
  }
  EXPECT_TRUE(queue.take().empty());
  EXPECT_EQ(queue.dropped().total(), 0U);
}

}  // namespace
}  // namespace sonard::server
