// SPDX-License-Identifier: Apache-2.0
#include "server/net/faulty_link.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

Datagram numbered(int number) {
  Datagram datagram;
  datagram.bytes = SharedBytes(std::vector<std::uint8_t>{static_cast<std::uint8_t>(number & 0xFF),
                                                         static_cast<std::uint8_t>(number >> 8)});
  return datagram;
}

int number_of(const Datagram& datagram) {
  return datagram.bytes[0] | datagram.bytes[1] << 8;
}

std::vector<int> numbers_of(const std::vector<Datagram>& datagrams) {
  std::vector<int> numbers;
  for (const Datagram& datagram : datagrams) {
    numbers.push_back(number_of(datagram));
  }
  return numbers;
}

// Pushes 0..count-1, one each millisecond, and returns all datagrams that come out, in order.
std::vector<int> run(FaultyLink& link, int count) {
  std::vector<int> out;
  TimePoint now{0};
  for (int i = 0; i < count; ++i, now += milliseconds{1}) {
    link.push(now, numbered(i));
    const std::vector<int> due = numbers_of(link.take_due(now));
    out.insert(out.end(), due.begin(), due.end());
  }
  const std::vector<int> rest = numbers_of(link.take_due(now + std::chrono::hours{1}));
  out.insert(out.end(), rest.begin(), rest.end());
  EXPECT_EQ(link.next_due(), std::nullopt);
  return out;
}

TEST(FaultyLink, PassesEverythingAtOnceWithoutFaults) {
  FaultyLink link({}, 1);
  link.push(milliseconds{5}, numbered(1));
  link.push(milliseconds{5}, numbered(2));
  EXPECT_EQ(link.next_due(), TimePoint{milliseconds{5}});
  EXPECT_EQ(numbers_of(link.take_due(milliseconds{5})), (std::vector{1, 2}));
  EXPECT_EQ(link.counters().passed, 2u);
}

TEST(FaultyLink, LosesTheConfiguredShare) {
  FaultyLink link({.loss = 0.05}, 7);
  const int count = 20000;
  const std::vector<int> out = run(link, count);
  // Binomial distribution: the standard deviation sqrt(n p q) is 30.8, and the limit is six of them.
  EXPECT_NEAR(static_cast<double>(link.counters().lost), 0.05 * count, 6 * std::sqrt(count * 0.05 * 0.95));
  EXPECT_EQ(out.size() + link.counters().lost, static_cast<std::size_t>(count));
  EXPECT_TRUE(std::is_sorted(out.begin(), out.end()));
}

TEST(FaultyLink, LossOfOneLosesEverythingAndOfZeroNothing) {
  FaultyLink all({.loss = 1.0}, 3);
  EXPECT_TRUE(run(all, 100).empty());
  FaultyLink none({.loss = 0.0, .duplicate = 0.0, .reorder = 0.0}, 3);
  EXPECT_EQ(run(none, 100).size(), 100u);
}

TEST(FaultyLink, SameSeedSameFateOtherSeedOtherFate) {
  const LinkFaults faults{.loss = 0.2, .duplicate = 0.1, .reorder = 0.1, .jitter = milliseconds{3}};
  FaultyLink first(faults, 42);
  FaultyLink second(faults, 42);
  FaultyLink other(faults, 43);
  const std::vector<int> expected = run(first, 500);
  EXPECT_EQ(run(second, 500), expected);
  EXPECT_NE(run(other, 500), expected);
}

TEST(FaultyLink, LossOfADatagramDoesNotDependOnTheOtherFaults) {
  FaultyLink plain({.loss = 0.2}, 9);
  FaultyLink delayed({.loss = 0.2, .duplicate = 1.0, .delay = milliseconds{2}, .jitter = milliseconds{9}}, 9);
  const std::vector<int> a = run(plain, 300);
  const std::vector<int> b = run(delayed, 300);
  EXPECT_EQ(std::set<int>(a.begin(), a.end()), std::set<int>(b.begin(), b.end()));
}

TEST(FaultyLink, DelaysByTheConfiguredTimeAndKeepsTheOrder) {
  FaultyLink link({.delay = milliseconds{20}}, 1);
  link.push(TimePoint{0}, numbered(1));
  link.push(TimePoint{0}, numbered(2));
  EXPECT_EQ(link.next_due(), TimePoint{milliseconds{20}});
  EXPECT_TRUE(link.take_due(milliseconds{20} - TimePoint{1}).empty());
  EXPECT_EQ(numbers_of(link.take_due(milliseconds{20})), (std::vector{1, 2}));
}

TEST(FaultyLink, JitterStaysInItsInterval) {
  FaultyLink link({.delay = milliseconds{5}, .jitter = milliseconds{10}}, 11);
  TimePoint earliest = std::chrono::hours{1};
  TimePoint latest{0};
  for (int i = 0; i < 1000; ++i) {
    link.push(TimePoint{0}, numbered(i));
    const TimePoint due = link.next_due().value();
    earliest = std::min(earliest, due);
    latest = std::max(latest, due);
    link.take_due(due);
  }
  EXPECT_GE(earliest, TimePoint{milliseconds{5}});
  EXPECT_LE(latest, TimePoint{milliseconds{15}});
  EXPECT_LT(earliest, TimePoint{microseconds{5500}});  // some of 1000 draws fall near each end
  EXPECT_GT(latest, TimePoint{microseconds{14500}});
}

TEST(FaultyLink, DuplicatesEach) {
  FaultyLink link({.duplicate = 1.0}, 5);
  EXPECT_EQ(run(link, 3), (std::vector{0, 0, 1, 1, 2, 2}));
  EXPECT_EQ(link.counters().duplicated, 3u);
}

TEST(FaultyLink, ReorderingSwapsNeighboursAndLosesNothing) {
  FaultyLink link({.reorder = 1.0}, 5);
  EXPECT_EQ(run(link, 6), (std::vector{1, 0, 3, 2, 5, 4}));
}

TEST(FaultyLink, HeldBackDatagramLeavesWhenNoneFollows) {
  FaultyLink link({.reorder = 1.0}, 5);
  link.push(TimePoint{0}, numbered(1));
  EXPECT_TRUE(link.take_due(milliseconds{9}).empty());
  ASSERT_EQ(link.next_due(), TimePoint{milliseconds{10}});
  EXPECT_EQ(numbers_of(link.take_due(milliseconds{10})), (std::vector{1}));
}

TEST(LinkConfig, IsToldToPeople) {
  EXPECT_EQ(faults_text({}), "");
  EXPECT_EQ(
      faults_text({.to_client = {.loss = 0.05, .delay = milliseconds{20}},
                   .from_client = {.duplicate = 0.01, .reorder = 0.005, .jitter = milliseconds{3}}}),
      "to clients: 5 % lost, 20 ms later; from clients: 1 % twice, 0.5 % out of order, 0 ms to 3 ms later");
}

}  // namespace
}  // namespace sonard::server
