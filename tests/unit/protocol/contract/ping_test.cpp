// SPDX-License-Identifier: Apache-2.0
// Pings in real time: jobs, their answers, and what follows them.
#include <algorithm>
#include <cstddef>

#include "tests/unit/protocol/contract/contract_test.hpp"

namespace sonard::contract {
namespace {

using Pings = Contract;

TEST_P(Pings, NoneBeginsWithoutARequest) {
  HeadBench bench(GetParam());
  bench.connect();
  bench.run_for(5s);
  EXPECT_TRUE(bench.jobs.empty());
}

TEST_P(Pings, EachHasAJobAndARecordWithItsNumberAndTime) {
  HeadBench bench(GetParam());
  bench.connect();
  while (bench.records.size() < 20) {
    const std::size_t before = bench.records.size();
    const std::size_t sent_before = bench.sent.size();
    bench.request();
    bench.run_for(300ms);
    ASSERT_GT(bench.records.size(), before);
    EXPECT_GT(bench.sent.size(), sent_before);
  }
  for (std::size_t i = 0; i < bench.records.size(); ++i) {
    const PingJob& job = bench.jobs.at(i);
    EXPECT_EQ(job.number, i);
    EXPECT_EQ(job.record, std::nullopt);
    EXPECT_EQ(job.transmit_us, static_cast<std::uint64_t>(job.transmit_time / 1us));
    EXPECT_GT(job.listening_time, 0ns);
    EXPECT_GE(job.period, job.listening_time);
    EXPECT_GT(job.range_m(), 0.0);
    EXPECT_FALSE(job.settings.empty());
    const PingRecord& record = bench.records[i];
    EXPECT_EQ(record.number, i);
    EXPECT_EQ(record.transmit_time, job.transmit_time);
    const auto samples = static_cast<std::size_t>(record.settings.bins * record.settings.beams);
    EXPECT_EQ(record.samples.size(), samples);
    EXPECT_EQ(record.bearings_rad.size(), static_cast<std::size_t>(record.settings.beams));
  }
  EXPECT_EQ(bench.head->device().progress().sent, bench.counters().pings_sent);
  EXPECT_EQ(bench.head->device().progress().ended, bench.ended());
}

TEST_P(Pings, TheNextWaitsUntilTheJobIsAnswered) {
  HeadBench bench(GetParam());
  bench.connect();
  bench.renderer_answers = false;
  for (int i = 0; i < 20; ++i) {
    bench.request();
    bench.run_for(100ms);
    ASSERT_EQ(bench.jobs.size(), 1U);
    EXPECT_TRUE(bench.records.empty());
  }
  bench.renderer_answers = true;
  bench.answer(bench.render(bench.jobs[0]));
  bench.request();
  bench.run_for(300ms);
  EXPECT_GT(bench.jobs.size(), 1U);
}

TEST_P(Pings, OneThatCannotBeRenderedIsCountedAndTheNextIsSent) {
  HeadBench bench(GetParam());
  bench.connect();
  bench.renderer_fails = true;
  bench.request();
  bench.run_for(300ms);
  EXPECT_GE(bench.counters().pings_failed, 1U);
  EXPECT_TRUE(bench.records.empty());
  EXPECT_EQ(bench.counters().pings_sent, 0U);
  bench.renderer_fails = false;
  bench.request();
  bench.run_for(300ms);
  EXPECT_GE(bench.counters().pings_sent, 1U);
}

TEST_P(Pings, AnImageOfTheWrongSizeIsCountedAsFailedAndTheNextIsSent) {
  for (const std::ptrdiff_t excess : {-1, 1, -1'000'000}) {
    HeadBench bench(GetParam());
    bench.connect();
    const auto good = bench.render;
    bench.render = [&](const PingJob& job) {
      PingImage image = good(job);
      const auto resized = [&](auto& samples) {
        const auto size = static_cast<std::ptrdiff_t>(samples.size()) + excess;
        samples.resize(static_cast<std::size_t>(std::max<std::ptrdiff_t>(size, 0)));
      };
      if (job.directions.any()) {
        resized(image.directions.range_m);
      } else {
        job.sixteen_bit ? resized(image.u16) : resized(image.u8);
      }
      return image;
    };
    bench.request();
    bench.run_for(300ms);
    EXPECT_GE(bench.counters().pings_failed, 1U) << excess;
    EXPECT_TRUE(bench.records.empty()) << excess;
    bench.render = good;
    bench.request();
    bench.run_for(300ms);
    EXPECT_GE(bench.counters().pings_sent, 1U) << excess;
  }
}

TEST_P(Pings, AnswersToNoJobAreCountedAndDropped) {
  HeadBench bench(GetParam());
  bench.connect();
  bench.answer({0, {1, 2, 3}, {}});
  bench.fail(5);
  bench.renderer_answers = false;
  bench.request();
  ASSERT_EQ(bench.jobs.size(), 1U);
  PingImage other = bench.render(bench.jobs[0]);
  other.number = 77;
  bench.answer(other);
  bench.fail(78);
  EXPECT_EQ(bench.counters().stale_images, 4U);
  EXPECT_EQ(bench.ended(), 0U);
  bench.answer(bench.render(bench.jobs[0]));
  bench.answer(bench.render(bench.jobs[0]));
  EXPECT_EQ(bench.counters().stale_images, 5U);
  bench.run_for(300ms);
  EXPECT_EQ(bench.records.size(), 1U);
}

TEST_P(Pings, ACancelledJobIsNamedUntilItIsAnsweredAndNoneFollowsBefore) {
  for (const bool rendered : {false, true}) {
    HeadBench bench(GetParam());
    bench.connect();
    bench.renderer_answers = false;
    bench.request();
    ASSERT_EQ(bench.jobs.size(), 1U);
    EXPECT_EQ(bench.last.cancelled, std::nullopt);
    bench.cancel();
    EXPECT_EQ(bench.last.cancelled, 0U);
    bench.request();
    bench.run_for(2s);
    EXPECT_EQ(bench.last.cancelled, 0U);
    EXPECT_EQ(bench.jobs.size(), 1U);
    rendered ? bench.answer(bench.render(bench.jobs[0])) : bench.fail(0);
    EXPECT_EQ(bench.last.cancelled, std::nullopt);
    EXPECT_EQ(bench.counters().stale_images, rendered ? 1U : 0U);
    bench.request();
    bench.run_for(300ms);
    ASSERT_EQ(bench.jobs.size(), 2U);
    EXPECT_EQ(bench.jobs[1].number, 1U);
    EXPECT_TRUE(bench.records.empty());
    EXPECT_EQ(bench.counters().pings_cancelled, 1U);
    EXPECT_EQ(bench.counters().pings_failed, 0U);
  }
}

TEST_P(Pings, AHeadWhoseClientHasGoneSaysSo) {
  HeadBench bench(GetParam());
  for (int i = 0; i < 3; ++i) {
    bench.connect();
    bench.request();
    EXPECT_FALSE(bench.last.nobody_there);
    bench.leave();
    EXPECT_TRUE(bench.last.nobody_there);
  }
}

TEST_P(Pings, GoOnWhenTheHeadIsSteppedLate) {
  HeadBench bench(GetParam());
  bench.connect();
  bench.lateness = [] { return 40ms; };
  bench.render_time = 15ms;
  for (std::size_t i = 1; i <= 20; ++i) {
    bench.request();
    bench.run_for(500ms);
    EXPECT_GE(bench.records.size(), i);
  }
}

// DeviceBench expects at each step that the head wants to be stepped later than now.
TEST_P(Pings, NothingHappensTwiceWhileTimeStandsStill) {
  HeadBench bench(GetParam());
  bench.connect();
  bench.renderer_answers = false;
  bench.request();
  for (int i = 0; i < 3; ++i) {
    const std::size_t before = bench.sent.size();
    for (int k = 0; k < 100; ++k) {
      bench.step(TimePassed{});
    }
    EXPECT_EQ(bench.sent.size(), before);
    EXPECT_EQ(bench.jobs.size(), 1U);
    bench.run_for(100ms);
  }
}

TEST_P(Pings, TheSameEventsAtTheSameTimesGiveTheSameBytes) {
  const auto run = [] {
    HeadBench bench(GetParam());
    bench.connect();
    bench.render_time = 7ms;
    for (int i = 0; i < 10; ++i) {
      bench.request();
      bench.run_for(123ms);
    }
    bench.leave();
    std::vector<std::vector<std::uint8_t>> sent;
    for (const Outgoing& message : bench.sent) {
      sent.emplace_back(message.bytes.begin(), message.bytes.end());
    }
    return sent;
  };
  EXPECT_EQ(run(), run());
}

TEST_P(Pings, CountersComeInOneOrderAndGrowAndHaveAMeaningAndThoseThatWarnHaveAText) {
  HeadBench bench(GetParam());
  const std::vector<Counter> before = bench.head->device().counts();
  bench.connect();
  bench.request();
  bench.run_for(1s);
  const std::vector<Counter> after = bench.head->device().counts();
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(before[i].name, after[i].name);
    EXPECT_GE(after[i].value, before[i].value);
    EXPECT_NE(after[i].meaning, "") << after[i].name;
    EXPECT_TRUE(after[i].fault == Counter::Fault::none || after[i].value == 0)
        << after[i].name << ": this client makes no fault";
    EXPECT_EQ(after[i].warning.starts_with("{} "), after[i].shown == Counter::Shown::warns) << after[i].name;
    EXPECT_EQ(std::ranges::count(after, after[i].name, &Counter::name), 1) << after[i].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, Pings, ::testing::ValuesIn(head_types()), name_of);

}  // namespace
}  // namespace sonard::contract
