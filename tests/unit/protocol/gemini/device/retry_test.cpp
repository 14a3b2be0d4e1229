// SPDX-License-Identifier: Apache-2.0
// Retry requests: which ones the head serves, and when (protocol/gemini/README.md 7.3).
#include "protocol/gemini/retry_queue.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

/// The ping datagrams in the order of sending, from index `from` on: "H", "3", "T" for originals, "h", "r3",
/// "t" for repetitions.
std::vector<std::string> story(const Bench& bench, std::size_t from = 0) {
  std::vector<std::string> words;
  for (const auto& datagram : bench.ping_datagrams(from)) {
    const auto report = decode_report(datagram.bytes).value();
    if (const auto* head = std::get_if<PingHead>(&report)) {
      words.emplace_back((head->ping_id & 0x100) != 0 ? "h" : "H");
    } else if (const auto* line = std::get_if<PingLine>(&report)) {
      words.push_back(std::string(line->resent() ? "r" : "").append(std::to_string(line->line_number())));
    } else if (const auto* tail = std::get_if<PingTail>(&report)) {
      words.emplace_back(tail->resent() ? "t" : "T");
    }
  }
  return words;
}

using Words = std::vector<std::string>;

TEST(Retries, AreServedInOrderWithTheirMarks) {
  Bench bench;
  bench.command(ping_of(100));
  bench.run_for(50ms);
  const std::size_t before = bench.sent.size();
  bench.command(retry_of(RetryKind::lines, 40, 3));
  bench.command(retry_of(RetryKind::tail));
  bench.command(retry_of(RetryKind::lines, 7));
  bench.command(retry_of(RetryKind::head));
  bench.run_for(50ms);
  EXPECT_EQ(story(bench, before), (Words{"r40", "r41", "r42", "t", "r7", "h"}));
  EXPECT_EQ(bench.device.counters().lines_resent, 4U);
  EXPECT_EQ(bench.device.counters().tails_resent, 1U);
  EXPECT_EQ(bench.device.counters().heads_resent, 1U);
}

TEST(Retries, AreIdenticalButForTheMark) {
  Bench bench;
  PingConfig config = ping_of(100);
  config.rle_threshold = 100;
  bench.command(config);
  bench.run_for(50ms);
  const auto original = bench.ping_datagrams();
  for (const int line : {0, 50, 99}) {
    bench.command(retry_of(RetryKind::lines, line));
    auto expected = copy(original[static_cast<std::size_t>(line) + 1].bytes);
    expected[11] |= 0x80;
    EXPECT_EQ(copy(bench.sent.back().bytes), expected);
  }
  bench.command(retry_of(RetryKind::head));
  auto head = copy(original.front().bytes);
  head[9] = 0x01;
  EXPECT_EQ(copy(bench.sent.back().bytes), head);
  bench.command(retry_of(RetryKind::tail));
  auto tail = copy(original.back().bytes);
  tail[9] = 0x80;
  EXPECT_EQ(copy(bench.sent.back().bytes), tail);
}

TEST(Retries, WaitForTheOriginalTail) {
  Bench bench;
  bench.command(ping_of(500));
  bench.run_for(5ms);
  bench.command(retry_of(RetryKind::lines, 10));
  bench.command(retry_of(RetryKind::tail));
  bench.run_for(100ms);
  const auto words = story(bench);
  ASSERT_EQ(words.size(), 504U);
  EXPECT_EQ(words[501], "T");
  EXPECT_EQ(words[502], "r10");
  EXPECT_EQ(words[503], "t");
}

TEST(Retries, AreAnsweredFast) {
  Bench bench;
  bench.command(ping_of(500));
  bench.run_for(100ms);
  for (const auto kind : {RetryKind::lines, RetryKind::tail, RetryKind::head}) {
    bench.run_for(1ms);
    bench.command(retry_of(kind, 3));
    EXPECT_EQ(bench.sent.back().at, bench.now);
  }
}

TEST(Retries, OnlyLinesThatExistAreSent) {
  Bench bench;
  bench.command(ping_of(100));
  bench.run_for(50ms);
  const std::size_t before = bench.sent.size();
  bench.command(retry_of(RetryKind::lines, 98, 65535));
  bench.command(retry_of(RetryKind::lines, 5, 0));  // a count of 0 means 1
  bench.command(retry_of(RetryKind::lines, 100));
  bench.command(retry_of(static_cast<RetryKind>(3)));
  bench.run_for(50ms);
  EXPECT_EQ(story(bench, before), (Words{"r98", "r99", "r5"}));
  EXPECT_EQ(bench.device.counters().retries_dropped, 2U);
}

TEST(Retries, BeforeTheStreamPingThereIsNothingToSend) {
  Bench bench;
  bench.command(retry_of(RetryKind::head));
  bench.command(retry_of(RetryKind::lines));
  bench.command(retry_of(RetryKind::tail));
  bench.run_for(100ms);
  EXPECT_TRUE(bench.ping_datagrams().empty());
  EXPECT_EQ(bench.device.counters().retries_dropped, 3U);
}

TEST(Retries, AreServedWhileTheNextPingIsRendered) {
  Bench bench;
  bench.command(ping_of(100));
  bench.run_for(50ms);
  bench.render_time = 80ms;
  bench.command(ping_of(200));
  bench.run_for(20ms);
  const std::size_t before = bench.sent.size();
  bench.command(retry_of(RetryKind::lines, 10));
  bench.run_for(5ms);
  EXPECT_EQ(story(bench, before), Words{"r10"});
}

TEST(Retries, ArePendingNoMoreOnceTheNextHeadHasLeft) {
  Bench bench;
  auto slow = to_head<NetworkConfig>();
  slow.inter_packet_gap = 65535;  // 524 us each: 100 lines take 52 ms, longer than a head is held
  bench.command(slow);
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(99ms);
  bench.command(retry_of(RetryKind::lines, 0, 100));
  bench.command(retry_of(RetryKind::lines, 0, 100));
  bench.run_until(250ms);
  const auto words = story(bench);
  const auto second_head = std::find(words.begin() + 1, words.end(), "H");
  ASSERT_NE(second_head, words.end());
  EXPECT_EQ(*(second_head - 1), "r97");  // r0 at 99 ms, 97 more until 150 ms
  EXPECT_TRUE(std::none_of(second_head, words.end(), [](const std::string& word) { return word[0] == 'r'; }));
  EXPECT_GT(bench.device.counters().retries_dropped, 0U);
}

TEST(Retries, HoldTheNextContinuousHeadForTenMilliseconds) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(95ms);
  bench.command(retry_of(RetryKind::tail));
  bench.run_until(150ms);
  const auto heads = bench.all<PingHead>();
  ASSERT_EQ(heads.size(), 2U);
  EXPECT_EQ(heads[1].first, 105ms);
  EXPECT_EQ(heads[1].second.transmit_time_us, 100'000U);
}

TEST(Retries, DoNotHoldAHeadThatIsFarAway) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(80ms);
  bench.command(retry_of(RetryKind::tail));
  bench.run_until(150ms);
  EXPECT_EQ(bench.all<PingHead>()[1].first, 100ms);
}

TEST(Retries, HoldTheNextHeadForFiftyMillisecondsAtMost) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  for (int i = 0; i < 40; ++i) {  // a request every 5 ms from 50 to 245 ms
    bench.run_until(50ms + 5ms * i);
    bench.command(retry_of(RetryKind::tail));
  }
  const auto heads = bench.all<PingHead>();
  ASSERT_GE(heads.size(), 2U);
  EXPECT_EQ(heads[1].first, 150ms);
}

TEST(Retries, AskedForInSinglePingModeAreServedBeforeTheNextHeadAndNoLonger) {
  Bench bench;
  bench.command(ping_of(1000));
  bench.run_for(100ms);
  const std::size_t before = bench.sent.size();
  bench.command(retry_of(RetryKind::lines, 0, 100));  // 2.7 ms of lines, the first 32 at once
  bench.command(ping_of(100));
  bench.run_for(100ms);
  const auto words = story(bench, before);
  ASSERT_EQ(words.size(), 100U + 102U);
  EXPECT_EQ(words[99], "r99");
  EXPECT_EQ(words[100], "H");
  EXPECT_LT(bench.all<PingHead>(before)[0].first, 100ms + 3ms)
      << "who asks for the next one is done with the last";
}

TEST(Retries, HoldAHeadThatWasAskedForBeforeThem) {
  Bench bench;
  bench.command(ping_of(2000));  // 54 ms
  bench.run_until(10ms);
  bench.command(ping_of(100));  // this client does not wait for the end of a ping
  bench.run_until(20ms);
  bench.command(retry_of(RetryKind::lines, 10));
  bench.run_until(60ms);  // less than 10 ms after r10, which left with the tail
  bench.command(retry_of(RetryKind::tail));
  bench.run_until(200ms);
  const auto words = story(bench);
  ASSERT_EQ(words.size(), 2002U + 2U + 102U);
  EXPECT_EQ(words[2002], "r10");
  EXPECT_EQ(words[2003], "t");
  EXPECT_EQ(words[2004], "H");
}

TEST(Retries, StillWorkAfterSilence) {
  Bench bench;
  bench.command(ping_of(100));
  bench.run_for(5s);
  const std::size_t before = bench.sent.size();
  bench.command(retry_of(RetryKind::lines, 10));
  EXPECT_EQ(story(bench, before), Words{"r10"});
}

TEST(Retries, EndSomeTime) {
  Bench bench;
  bench.command(ping_of(100));
  bench.run_for(50ms);
  for (int i = 0; i < 1000; ++i) {
    bench.command(retry_of(RetryKind::lines, 10));
    bench.run_for(1ms);
  }
  EXPECT_EQ(bench.device.counters().lines_resent, 16U);
}

RetryRequest lines(int first, int count) {
  return retry_of(RetryKind::lines, first, count);
}

std::vector<int> drain(RetryQueue& queue) {
  std::vector<int> popped;
  while (const auto resend = queue.pop()) {
    popped.push_back(resend->kind == RetryKind::lines ? resend->line : -static_cast<int>(resend->kind) - 1);
  }
  return popped;
}

TEST(RetryQueue, JoinsWhatGoesOnOrRepeats) {
  RetryQueue queue;
  queue.reset(100);
  EXPECT_TRUE(queue.push(lines(10, 1)));
  EXPECT_TRUE(queue.push(lines(11, 2)));
  EXPECT_TRUE(queue.push(lines(12, 1)));
  EXPECT_EQ(queue.size(), 1U);
  EXPECT_EQ(queue.pending(100), 3);
  EXPECT_EQ(queue.pending(2), 2);
  EXPECT_TRUE(queue.push(retry_of(RetryKind::tail)));
  EXPECT_TRUE(queue.push(retry_of(RetryKind::tail)));
  EXPECT_TRUE(queue.push(lines(9, 1)));
  EXPECT_EQ(queue.size(), 3U);
  EXPECT_EQ(drain(queue), (std::vector<int>{10, 11, 12, -3, 9}));
  EXPECT_TRUE(queue.empty());
}

TEST(RetryQueue, LineServedAlreadyCanBeAskedForAgain) {
  RetryQueue queue;
  queue.reset(100);
  EXPECT_TRUE(queue.push(lines(10, 2)));
  EXPECT_EQ(queue.pop(), (RetryQueue::Resend{RetryKind::lines, 10}));
  EXPECT_TRUE(queue.push(lines(10, 1)));
  EXPECT_EQ(drain(queue), (std::vector<int>{11, 10}));
}

TEST(RetryQueue, IsBounded) {
  RetryQueue queue;
  queue.reset(20000);
  for (int i = 0; i < 20000; i += 2) {  // no ranges to join
    EXPECT_EQ(queue.push(lines(i, 1)), i < 8192);
  }
  EXPECT_EQ(queue.size(), 4096U);
}

TEST(RetryQueue, EndsAtTheLastLine) {
  RetryQueue queue;
  queue.reset(10);
  EXPECT_FALSE(queue.push(lines(10, 1)));
  EXPECT_TRUE(queue.push(lines(8, 65535)));
  EXPECT_EQ(drain(queue), (std::vector<int>{8, 9}));
}

}  // namespace
}  // namespace sonard::gemini
