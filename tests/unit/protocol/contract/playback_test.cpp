// SPDX-License-Identifier: Apache-2.0
// A head that plays back sends the pings that it is fed, when they are due and a client requests one.
#include "tests/unit/protocol/contract/contract_test.hpp"

namespace sonard::contract {
namespace {

struct Playback : Contract {
  HeadBench bench{GetParam(), {.plays_back = true}};

  Playback() { bench.connect(); }
};

TEST_P(Playback, NothingIsSentThatIsNotFed) {
  bench.request();
  bench.run_for(2s);
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_TRUE(bench.records.empty());
  bench.feed(7);
  bench.run_for(300ms);
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.jobs[0].record, 7U);
  EXPECT_EQ(bench.records.size(), 1U);
}

TEST_P(Playback, NothingIsSentThatIsNotRequested) {
  bench.feed(7);
  bench.run_for(2s);
  EXPECT_TRUE(bench.jobs.empty());
  bench.request();
  EXPECT_EQ(bench.jobs.size(), 1U);
}

TEST_P(Playback, APingIsFedInPlaceOfTheOneBeforeAndIsSentOnce) {
  bench.feed(5);
  bench.feed(6);
  bench.step(PingFed{std::nullopt});
  bench.request();
  EXPECT_TRUE(bench.jobs.empty());
  bench.feed(7);
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.jobs[0].record, 7U);
  bench.run_for(300ms);
  bench.request();
  bench.run_for(1s);
  EXPECT_EQ(bench.jobs.size(), 1U);
}

TEST_P(Playback, WhatIsRecordedAgainIsWhatWasFed) {
  bench.feed(3);
  bench.request();
  bench.run_for(300ms);
  ASSERT_EQ(bench.records.size(), 1U);
  const ReplayedPing fed = bench.head->recorded();
  EXPECT_EQ(bench.records[0].settings.bins, fed.settings.bins);
  EXPECT_EQ(bench.records[0].settings.beams, fed.settings.beams);
  EXPECT_EQ(bench.records[0].settings.sound_speed_mps, fed.settings.sound_speed_mps);
  EXPECT_EQ(bench.records[0].samples, bench.render(bench.jobs.at(0)).u8);
}

TEST_P(Playback, APingKeepsItsTime) {
  const TimePoint due = bench.now + 700ms;
  bench.feed(0, due);
  bench.request();
  bench.run_until(due - 1ms);
  EXPECT_TRUE(bench.records.empty());
  bench.run_for(300ms);
  ASSERT_EQ(bench.records.size(), 1U);
  EXPECT_EQ(bench.jobs.at(0).transmit_time, due);
}

TEST_P(Playback, APingThatIsLateIsSentAtOnce) {
  bench.run_for(900ms);
  bench.feed(0, bench.now - 200ms);
  bench.request();
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.jobs[0].transmit_time, bench.now);
}

TEST_P(Playback, ARecordingThatNoHeadCouldSendIsNone) {
  bench.feed(1);
  bench.step(PingFed{ReplayedPing{}});
  bench.request();
  bench.run_for(1s);
  EXPECT_TRUE(bench.jobs.empty());
}

INSTANTIATE_TEST_SUITE_P(Devices, Playback, ::testing::ValuesIn(head_types()), name_of);

}  // namespace
}  // namespace sonard::contract
