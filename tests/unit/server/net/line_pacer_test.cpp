// SPDX-License-Identifier: Apache-2.0
// The line as a queue: ten bits per byte, one byte after the other.
#include "server/net/line_pacer.hpp"

#include <string>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Pacer = LinePacer<std::string>;

TEST(LinePacer, AByteTakesTenBits) {
  Pacer pacer(10'000, 1000);  // one byte per millisecond
  ASSERT_TRUE(pacer.push(seconds{5}, "ab", 2));
  EXPECT_EQ(pacer.next_due(), seconds{5} + milliseconds{2});
  EXPECT_FALSE(pacer.pop_due(seconds{5} + milliseconds{2} - TimePoint{1}));
  EXPECT_EQ(pacer.pop_due(seconds{5} + milliseconds{2}), "ab");
  EXPECT_FALSE(pacer.next_due());
}

TEST(LinePacer, AgreesWithTheTimesOfTheDocument) {
  // protocol/micron/README.md 8.4: T_tx of 245, 445 and 545 bytes at 115200 baud is 21.3, 38.6 and 47.3 ms.
  for (const auto& [size, expected_us] : {std::pair{245U, 21'300}, {445U, 38'600}, {545U, 47'300}}) {
    Pacer pacer(115'200, 1000);
    pacer.push(TimePoint{0}, "", size);
    EXPECT_NEAR(static_cast<double>(pacer.next_due()->count()) / 1000.0, expected_us, 50.0) << size;
  }
}

TEST(LinePacer, ItemsFollowEachOther) {
  Pacer pacer(10'000, 1000);
  pacer.push(milliseconds{0}, "first", 10);
  pacer.push(milliseconds{4}, "second", 5);
  EXPECT_EQ(pacer.pop_due(milliseconds{10}), "first");
  EXPECT_FALSE(pacer.pop_due(milliseconds{14}));
  EXPECT_EQ(pacer.pop_due(milliseconds{15}), "second");
  pacer.push(milliseconds{100}, "third", 1);
  EXPECT_EQ(pacer.next_due(), milliseconds{101}) << "the line was idle";
}

TEST(LinePacer, AnEventKeepsItsPlaceBetweenBytes) {
  Pacer pacer(10'000, 10);
  pacer.push(milliseconds{0}, "bytes", 10);
  EXPECT_TRUE(pacer.push(milliseconds{1}, "event", 0)) << "takes no room";
  EXPECT_EQ(pacer.pop_due(milliseconds{10}), "bytes");
  EXPECT_EQ(pacer.pop_due(milliseconds{10}), "event");
}

TEST(LinePacer, RoundingDoesNotAddUp) {
  Pacer pacer(115'200, 1'000'000);
  for (int i = 0; i < 11'520; ++i) {
    pacer.push(TimePoint{0}, "", 1);
  }
  TimePoint last{0};
  while (pacer.next_due()) {
    last = *pacer.next_due();
    pacer.pop_due(last);
  }
  EXPECT_GE(last, seconds{1});
  EXPECT_LE(last, seconds{1} + microseconds{12}) << "at most a nanosecond for each item";
}

TEST(LinePacer, RefusesWhatWouldHaveToWaitTooLong) {
  Pacer pacer(10'000, 10);
  EXPECT_TRUE(pacer.push(milliseconds{0}, "six", 6));
  EXPECT_FALSE(pacer.push(milliseconds{0}, "five", 5));
  EXPECT_TRUE(pacer.push(milliseconds{0}, "four", 4));
  EXPECT_EQ(pacer.pop_due(milliseconds{6}), "six");
  EXPECT_TRUE(pacer.push(milliseconds{6}, "six", 6));
  EXPECT_EQ(pacer.waiting(), 2U);
}

TEST(LinePacer, IsIdleWhenCleared) {
  Pacer pacer(10'000, 10);
  pacer.push(milliseconds{0}, "gone", 10);
  pacer.clear();
  EXPECT_FALSE(pacer.pop_due(seconds{1}));
  EXPECT_TRUE(pacer.push(milliseconds{1}, "next", 10));
  EXPECT_EQ(pacer.next_due(), milliseconds{11});
}

TEST(LinePacer, WithoutASpeedEverythingIsThereAtOnce) {
  Pacer pacer(0, 1000);
  pacer.push(milliseconds{7}, "a", 500);
  pacer.push(milliseconds{7}, "b", 500);
  EXPECT_EQ(pacer.pop_due(milliseconds{7}), "a");
  EXPECT_EQ(pacer.pop_due(milliseconds{7}), "b");
}

}  // namespace
}  // namespace sonard::server
