// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/ping_cycle.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace sonard {
namespace {

using namespace std::chrono_literals;

ReplayedPing recording(std::uint64_t record, std::optional<TimePoint> due = std::nullopt) {
  ReplayedPing ping;
  ping.record = record;
  ping.due = due;
  return ping;
}

class PingCycleTest : public testing::Test {
 protected:
  explicit PingCycleTest(const PingCycle::Config& config = {}) : cycle(config, 1s, counters) {}

  Actions reported() {
    Actions actions;
    cycle.report(actions);
    return actions;
  }
  /// Begins a ping and returns the number of its job.
  std::uint64_t begin(TimePoint transmit_time = 2s) {
    cycle.begin({}, transmit_time);
    return reported().render.value().number;
  }

  PingCounters counters;
  PingCycle cycle;
};

TEST_F(PingCycleTest, AJobHasItsNumberAndTimes) {
  PingJob asked;
  asked.native_bins = 20;
  cycle.begin(asked, 3s);
  const PingJob job = reported().render.value();
  EXPECT_EQ(job.number, 0U);
  EXPECT_EQ(job.transmit_time, 3s);
  EXPECT_EQ(job.transmit_us, 2'000'000U) << "since the boot";
  EXPECT_EQ(job.native_bins, 20);
  EXPECT_EQ(job.record, std::nullopt);
  EXPECT_FALSE(reported().render.has_value()) << "a job is requested once";
  EXPECT_EQ(counters.pings_started, 1U);
}

TEST_F(PingCycleTest, APingIsRenderedThenSent) {
  const std::uint64_t number = begin(2s);
  EXPECT_TRUE(cycle.under_way());
  EXPECT_FALSE(cycle.rendered());
  EXPECT_EQ(cycle.next_start(0s, 0s), std::nullopt) << "one ping at a time";

  EXPECT_TRUE(cycle.on_image(4s, number));
  EXPECT_TRUE(cycle.rendered());
  EXPECT_EQ(cycle.answered_at(), 4s);
  EXPECT_EQ(cycle.next_start(0s, 0s), std::nullopt) << "the ping is not sent yet";

  PingRecord sent;
  sent.bits_per_bin = 4;
  cycle.put_on_wire(sent);
  EXPECT_FALSE(cycle.under_way());
  const PingRecord record = reported().record.value();
  EXPECT_EQ(record.number, number);
  EXPECT_EQ(record.transmit_time, 2s);
  EXPECT_EQ(record.bits_per_bin, 4);
  EXPECT_FALSE(reported().record.has_value());
  EXPECT_EQ(cycle.next_start(5s, 6s), TimePoint{6s});
  EXPECT_EQ(begin(), number + 1);
}

TEST_F(PingCycleTest, TheRateDelaysAPing) {
  EXPECT_EQ(cycle.next_start(5s, 3s), TimePoint{5s});
  EXPECT_EQ(cycle.next_start(3s, 5s), TimePoint{5s});
  EXPECT_TRUE(cycle.granted());
}

TEST_F(PingCycleTest, AnUnrenderedPingFails) {
  EXPECT_TRUE(cycle.on_image_failed(3s, begin()));
  EXPECT_FALSE(cycle.under_way());
  EXPECT_EQ(counters.pings_failed, 1U);
  EXPECT_EQ(cycle.next_start(0s, 0s), TimePoint{0s});
}

TEST_F(PingCycleTest, ADeviceRefusesAnImage) {
  EXPECT_TRUE(cycle.on_image(3s, begin()));
  cycle.fail();
  EXPECT_FALSE(cycle.under_way());
  EXPECT_EQ(counters.pings_failed, 1U);
  EXPECT_EQ(counters.pings_ended(), 1U);
}

TEST_F(PingCycleTest, ACancelledJobMustBeAnswered) {
  const std::uint64_t number = begin();
  EXPECT_EQ(reported().cancelled, std::nullopt);
  cycle.cancel();
  EXPECT_EQ(counters.pings_cancelled, 1U);
  EXPECT_EQ(reported().cancelled, number);
  EXPECT_EQ(reported().cancelled, number) << "a state, not an event";
  EXPECT_EQ(cycle.next_start(0s, 0s), std::nullopt);

  EXPECT_FALSE(cycle.on_image_failed(3s, number));
  EXPECT_EQ(reported().cancelled, std::nullopt);
  EXPECT_EQ(cycle.next_start(0s, 0s), TimePoint{0s});
  EXPECT_EQ(counters.pings_failed, 0U);
  EXPECT_EQ(counters.stale_images, 0U);
}

TEST_F(PingCycleTest, TheImageOfACancelledPingIsStale) {
  const std::uint64_t number = begin();
  cycle.cancel();
  EXPECT_FALSE(cycle.on_image(3s, number));
  EXPECT_EQ(cycle.answered_at(), 3s);
  EXPECT_EQ(counters.stale_images, 1U);
  EXPECT_EQ(reported().cancelled, std::nullopt);
}

TEST_F(PingCycleTest, ARenderedPingNeedsNoAnswerAfterItsCancellation) {
  cycle.on_image(3s, begin());
  cycle.cancel();
  EXPECT_EQ(reported().cancelled, std::nullopt);
  EXPECT_EQ(cycle.next_start(0s, 0s), TimePoint{0s});
}

TEST_F(PingCycleTest, CancellingNothingCountsNothing) {
  cycle.cancel();
  EXPECT_EQ(counters.pings_cancelled, 0U);
}

TEST_F(PingCycleTest, AnswersToOtherJobsAreStale) {
  EXPECT_FALSE(cycle.on_image(1s, 0)) << "no job";
  const std::uint64_t number = begin();
  EXPECT_FALSE(cycle.on_image(2s, number + 1));
  EXPECT_FALSE(cycle.on_image_failed(2s, number + 1));
  EXPECT_TRUE(cycle.under_way());
  EXPECT_EQ(cycle.answered_at(), 0s);
  EXPECT_TRUE(cycle.on_image(3s, number));
  EXPECT_FALSE(cycle.on_image(4s, number)) << "a second answer";
  EXPECT_TRUE(cycle.rendered());
  EXPECT_EQ(counters.stale_images, 4U);
}

TEST_F(PingCycleTest, ARebootKeepsTheUnansweredJob) {
  const std::uint64_t number = begin();
  cycle.reboot(10s);
  EXPECT_EQ(counters.pings_cancelled, 1U);
  EXPECT_EQ(reported().cancelled, number);
  cycle.on_image_failed(11s, number);
  cycle.begin({}, 12s);
  const PingJob job = reported().render.value();
  EXPECT_EQ(job.number, number + 1);
  EXPECT_EQ(job.transmit_us, 2'000'000U);
}

class SimulatedPingCycleTest : public PingCycleTest {
 protected:
  SimulatedPingCycleTest() : PingCycleTest({.simulated_time = true}) {}
};

TEST_F(SimulatedPingCycleTest, TheServerObservesTheRate) {
  EXPECT_EQ(cycle.next_start(3s, 5s), TimePoint{3s});
}

TEST_F(SimulatedPingCycleTest, AGrantIsForOnePing) {
  EXPECT_FALSE(cycle.granted());
  cycle.grant();
  EXPECT_TRUE(cycle.granted());
  begin();
  EXPECT_FALSE(cycle.granted());
  cycle.grant();
  cycle.skip();
  EXPECT_FALSE(cycle.granted()) << "the device made no ping of it";
}

class PlayingPingCycleTest : public PingCycleTest {
 protected:
  PlayingPingCycleTest() : PingCycleTest({.plays_back = true}) {}
};

TEST_F(PlayingPingCycleTest, EachPingNeedsItsRecording) {
  EXPECT_EQ(cycle.next_start(0s, 0s), std::nullopt);
  cycle.feed(recording(7));
  cycle.feed(recording(8));
  EXPECT_EQ(cycle.next_start(0s, 0s), TimePoint{0s});
  EXPECT_EQ(cycle.fed()->record, 8U);
  cycle.begin({}, 1s);
  EXPECT_EQ(reported().render->record, 8U);
  EXPECT_FALSE(cycle.fed().has_value());
  cycle.feed(recording(9));
  EXPECT_EQ(cycle.next_start(0s, 0s), std::nullopt) << "the first ping is under way";
  cycle.feed(std::nullopt);
  cycle.on_image_failed(2s, 0);
  EXPECT_EQ(cycle.next_start(0s, 0s), std::nullopt);
}

TEST_F(PlayingPingCycleTest, ARecordingSetsThePace) {
  cycle.feed(recording(7, 9s));
  EXPECT_EQ(cycle.next_start(3s, 5s), TimePoint{9s});
  EXPECT_EQ(cycle.next_start(3s, 12s), TimePoint{12s});
}

}  // namespace
}  // namespace sonard
