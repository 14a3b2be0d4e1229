// SPDX-License-Identifier: Apache-2.0
// The client against a scripted head, in virtual time.
#include "protocol/gemini/client.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "protocol/gemini/codec.hpp"

namespace sonard::gemini {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::uint16_t sonar_id = 601;
constexpr Ipv4 alternate = 0xC0A802C9;
constexpr std::uint64_t head_us_at_0 = 5'000'000;  // the head has run for 5 s at the start of a test
constexpr int lines = 40;

template <class Message>
Message from_head(Message message) {
  message.header.sonar_id = sonar_id;
  return message;
}

/// Line `number` of ping `id`: every sample differs from its neighbours in beam, line and ping.
std::vector<std::uint8_t> line_data(int id, int number) {
  std::vector<std::uint8_t> data(beam_count);
  for (int beam = 0; beam < beam_count; ++beam) {
    data[static_cast<std::size_t>(beam)] = static_cast<std::uint8_t>(beam * 7 + number * 13 + id * 29);
  }
  return data;
}

std::vector<std::uint8_t> image(int id) {
  std::vector<std::uint8_t> samples;
  for (int number = 0; number < lines; ++number) {
    const auto line = line_data(id, number);
    samples.insert(samples.end(), line.begin(), line.end());
  }
  return samples;
}

class ClientTest : public testing::Test {
 protected:
  PingConfig config(RunMode mode = RunMode::single) const {
    PingConfig made;
    made.end_range = lines;
    made.run_mode = static_cast<std::uint16_t>(mode);
    made.interping_us = 100'000;
    return made;
  }

  Status status() const {
    Status made = from_head(Status{});
    made.sonar_id = sonar_id;
    made.alternate_ip = alternate;
    made.clock_us = head_us_at_0 + static_cast<std::uint64_t>(now_ / 1us);
    return made;
  }

  template <class Message>
  void receive(const Message& message) {
    client_.on_datagram(now_, encode(Report{message}));
    client_.advance(now_);
  }

  void hear_head(int id, bool resent = false) { hear_head(id, now_, resent); }
  void hear_head(int id, TimePoint transmitted, bool resent = false) {
    PingHead head = from_head(PingHead{});
    head.ping_id = static_cast<std::uint16_t>(id | (resent ? 0x100 : 0));
    head.ext_mode = ext_bits::eight_bit;
    head.end_range = lines;
    head.transmit_time_us = head_us_at_0 + static_cast<std::uint64_t>(transmitted / 1us);
    receive(head);
  }
  void hear_line(int id, int number, bool resent = false) {
    PingLine line = from_head(PingLine{});
    const auto data = line_data(id, number);
    line.ping_id = static_cast<std::uint8_t>(id);
    line.line_id = static_cast<std::uint16_t>(number | (resent ? 0x8000 : 0));
    line.line_info = make_line_info(data.size(), number == lines - 1, ext_bits::eight_bit);
    line.data = data;
    receive(line);
  }
  void hear_lines(int id, int first, int count, bool resent = false) {
    for (int number = first; number < first + count; ++number) {
      hear_line(id, number, resent);
    }
  }
  void hear_tail(int id, bool resent = false) {
    PingTail tail = from_head(PingTail{});
    tail.ping_id = static_cast<std::uint8_t>(id);
    tail.flags = resent ? resent_tail : 0;
    receive(tail);
  }
  void hear_ping(int id) {
    hear_head(id);
    hear_lines(id, 0, lines);
    hear_tail(id);
  }

  /// Lets time pass, with a call of advance() at each deadline.
  void pass(std::chrono::nanoseconds span) {
    const TimePoint end = now_ + span;
    while (true) {
      const auto due = client_.next_deadline();
      if (!due || *due > end) {
        break;
      }
      now_ = std::max(now_, *due);
      client_.advance(now_);
    }
    now_ = end;
  }

  /// The messages of one type that the client has sent since the last call.
  template <class Message>
  std::vector<Message> said() {
    std::vector<Message> messages;
    for (const auto& datagram : client_.take_outgoing()) {
      EXPECT_EQ(datagram.to, alternate);
      const auto command = decode_command(datagram.bytes);
      EXPECT_TRUE(command.has_value());
      EXPECT_EQ(header_of(*command).sonar_id, sonar_id);
      if (const auto* message = std::get_if<Message>(&*command)) {
        messages.push_back(*message);
      }
    }
    return messages;
  }

  /// Retry requests since the last call, with copies of one datagram merged: "head", "tail", "10" or "10+3".
  std::vector<std::string> asked() {
    std::vector<std::string> requests;
    for (const auto& retry : said<RetryRequest>()) {
      std::string text = retry.kind == RetryKind::head ? "head" : "tail";
      if (retry.kind == RetryKind::lines) {
        text = std::to_string(retry.first_line);
        text += retry.line_count > 1 ? "+" + std::to_string(retry.line_count) : "";
      }
      if (requests.empty() || requests.back() != text) {
        requests.push_back(text);
      }
    }
    return requests;
  }

  /// Receives a status, drops the first messages of the client, and starts `pings` pings (0: without end).
  void meet_and_start(const PingConfig& wanted, std::uint64_t pings = 0) {
    receive(status());
    receive(from_head(Diagnostic{}));
    client_.start(now_, wanted, pings);
    client_.advance(now_);
    ASSERT_THAT(said<PingConfig>(), SizeIs(1));
    now_ += 1ms;
  }

  Client client_{ClientConfig{}};
  TimePoint now_ = 0s;
};

// ---- Meeting a head ----

TEST_F(ClientTest, IsSilentUntilAStatusComes) {
  client_.start(now_, config(), 1);
  pass(10s);
  EXPECT_THAT(client_.take_outgoing(), IsEmpty());
  EXPECT_FALSE(client_.head());
}

TEST_F(ClientTest, PingsOfAnUnknownHeadAreIgnored) {
  // An earlier client has ended, and its head still pings.
  client_.start(now_, config(RunMode::continuous), 1);
  hear_head(5);
  hear_lines(5, 0, 10);
  hear_lines(5, 20, 10);
  hear_tail(5);
  pass(1s);
  EXPECT_THAT(client_.take_outgoing(), IsEmpty());
  now_ += 1s;
  receive(status());
  EXPECT_THAT(said<PingConfig>(), SizeIs(1));
}

TEST_F(ClientTest, FirstContactIsNetworkConfigurationAndDiagnosticRequest) {
  receive(status());
  const auto sent = client_.take_outgoing();
  ASSERT_GE(sent.size(), 2U);
  // gemini.md 10, with bytes 6 and 7 as in the early library.
  EXPECT_EQ(sent[0].bytes,
            (std::vector<std::uint8_t>{0x31, 0x01, 0x59, 0x02, 0x00, 0x00, 0x00, 0x00, 0x0f, 0x0f, 0x00,
                                       0x00, 0x16, 0x05, 0x50, 0xc3, 0x00, 0x00, 0x00, 0x01, 0x10, 0x27}));
  EXPECT_EQ(sent[1].bytes, (std::vector<std::uint8_t>{0x36, 0x01, 0x59, 0x02, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sent[0].to, alternate);
}

TEST_F(ClientTest, AsksForTheDiagnosticAfterEachStatusUntilItComes) {
  receive(status());
  EXPECT_THAT(said<DiagnosticRequest>(), SizeIs(1));
  pass(1s);
  receive(status());
  EXPECT_THAT(said<DiagnosticRequest>(), SizeIs(1));
  receive(from_head(Diagnostic{}));
  pass(1s);
  receive(status());
  EXPECT_THAT(said<DiagnosticRequest>(), IsEmpty());
}

TEST_F(ClientTest, KeepsTheHeadAwakeEverySecond) {
  receive(status());
  pass(10s);
  EXPECT_THAT(said<StatusRequest>(), SizeIs(11));
}

TEST_F(ClientTest, HeadsThatCannotBeTalkedToAreLeftAlone) {
  Status nowhere = status();
  nowhere.alternate_ip = 0;
  receive(nowhere);
  Status production = status();
  production.sonar_id = production.header.sonar_id = 1;
  receive(production);
  Status contradictory = status();
  contradictory.header.sonar_id = 77;
  receive(contradictory);
  EXPECT_FALSE(client_.head());
  EXPECT_THAT(client_.take_outgoing(), IsEmpty());
}

TEST_F(ClientTest, TalksToOneHeadOnly) {
  receive(status());
  Status other = status();
  other.sonar_id = other.header.sonar_id = 777;
  other.alternate_ip = 0x0A0A0A0A;
  receive(other);
  EXPECT_EQ(client_.head()->status.sonar_id, sonar_id);
  EXPECT_THAT(client_.other_heads(), ElementsAre(testing::Pair(777, 0x0A0A0A0A)));
}

TEST_F(ClientTest, WaitsForTheHeadItWasToldToTalkTo) {
  client_ = Client(ClientConfig{.sonar_id = 777, .head_address = 0x0A0A0A0A});
  receive(status());
  EXPECT_FALSE(client_.head());
  Status wanted = status();
  wanted.sonar_id = wanted.header.sonar_id = 777;
  receive(wanted);
  ASSERT_TRUE(client_.head());
  EXPECT_EQ(client_.take_outgoing().at(0).to, 0x0A0A0A0AU);
}

TEST_F(ClientTest, BadDatagramsAreCounted) {
  client_.on_datagram(now_, std::vector<std::uint8_t>{0x41, 0x01, 0x59});
  client_.on_datagram(now_, {});
  EXPECT_EQ(client_.statistics().bad_datagrams, 2U);
}

// ---- Single pings ----

TEST_F(ClientTest, ACompletePingIsDeliveredAndTheNextConfigurationLeavesAtOnce) {
  meet_and_start(config(), 2);
  hear_ping(5);
  const auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_EQ(pings[0].samples.u8, image(5));
  EXPECT_TRUE(pings[0].complete());
  EXPECT_EQ(pings[0].retries.total(), 0U);
  EXPECT_THAT(said<PingConfig>(), SizeIs(1));
  EXPECT_FALSE(client_.finished());
  hear_ping(6);
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
  EXPECT_TRUE(client_.finished());
  EXPECT_THAT(said<PingConfig>(), IsEmpty());
}

TEST_F(ClientTest, AGapIsAskedForAsOneWhenItsLinesCannotBeLateAnyMore) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, 10);
  hear_line(5, 13);
  EXPECT_THAT(asked(), IsEmpty());
  pass(1ms);
  hear_line(5, 14);
  pass(1ms);
  hear_line(5, 15);
  EXPECT_THAT(asked(), ElementsAre("10+3"));
  hear_lines(5, 16, lines - 16);
  hear_tail(5);
  EXPECT_THAT(asked(), IsEmpty());
  hear_lines(5, 10, 3, true);
  const auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_EQ(pings[0].samples.u8, image(5));
  EXPECT_EQ(pings[0].lines_repaired, 3);
  EXPECT_EQ(pings[0].lines_lost, 0);
}

TEST_F(ClientTest, TheRequestForALineIsTheWorkedExample) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, 10);
  hear_lines(5, 11, lines - 11);
  hear_tail(5);
  const auto sent = client_.take_outgoing();
  ASSERT_THAT(sent, SizeIs(1));
  EXPECT_EQ(sent[0].bytes,
            (std::vector<std::uint8_t>{0x30, 0x01, 0x59, 0x02, 0, 0, 0, 0, 1, 0, 0x0a, 0, 1, 0, 0, 0}));
}

TEST_F(ClientTest, LastLinesAreAskedForWhenTheTailComes) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, lines - 2);
  hear_tail(5);
  EXPECT_THAT(asked(), ElementsAre("38+2"));
}

TEST_F(ClientTest, LinesAreAskedForUntilTheyCome) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, 10);
  hear_lines(5, 11, lines - 11);
  hear_tail(5);
  EXPECT_THAT(asked(), ElementsAre("10"));
  for (int round = 0; round < 9; ++round) {
    pass(101ms);
    EXPECT_THAT(asked(), ElementsAre("10")) << "round " << round;
  }
  hear_line(5, 10, true);
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
}

TEST_F(ClientTest, RequestsFollowQuicklyWhileAHeadMayHoldItsNextPing) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, 10);
  hear_lines(5, 11, lines - 11);
  hear_tail(5);
  static_cast<void>(asked());
  for (int round = 0; round < 3; ++round) {  // gemini.md 7.3: a head waits 10 ms after the last request
    pass(5ms);
    EXPECT_THAT(said<RetryRequest>(), SizeIs(testing::Ge(2U))) << "round " << round;
  }
}

TEST_F(ClientTest, ALostTailIsAskedFor) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, lines);
  EXPECT_THAT(client_.take_pings(), IsEmpty());
  pass(5ms);
  EXPECT_THAT(asked(), ElementsAre("tail"));
  hear_tail(5, true);
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
}

TEST_F(ClientTest, ATailThatNeverComesDoesNotSpoilTheImage) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, lines);
  pass(1s);
  const auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_TRUE(pings[0].complete());
}

TEST_F(ClientTest, LastLinesAndTailLostTogetherAreFoundByTheTimer) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, lines - 3);
  pass(10ms);
  EXPECT_THAT(asked(), testing::Each("tail"));
  hear_tail(5, true);
  EXPECT_THAT(asked(), ElementsAre("37+3"));
  hear_lines(5, lines - 3, 3, true);
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
}

// Otherwise the client would send a request in every ping of a head whose images are late (7.2).
TEST_F(ClientTest, APingThatStopsLongBeforeItsEndIsGivenAsLongAsByOtherClients) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, lines - 36);
  pass(390ms);
  EXPECT_THAT(asked(), IsEmpty());
  pass(30ms);
  EXPECT_THAT(asked(), ElementsAre("tail"));
}

TEST_F(ClientTest, ALostHeadIsAskedForAndTheLinesAreKept) {
  meet_and_start(config());
  hear_lines(5, 0, 10);
  pass(3ms);
  EXPECT_THAT(asked(), ElementsAre("head"));
  hear_lines(5, 10, lines - 11);
  hear_tail(5);
  hear_head(5, 0s + 1ms, true);
  EXPECT_THAT(asked(), ElementsAre("39"));  // the count of lines is unknown until now
  hear_line(5, lines - 1, true);
  const auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_EQ(pings[0].samples.u8, image(5));
  EXPECT_EQ(client_.statistics().configs_sent, 1U + 1U);  // plus the configuration of the next ping
}

TEST_F(ClientTest, AHeadRightAfterItsFirstLineIsNotAskedFor) {
  meet_and_start(config());
  hear_line(5, 0);
  hear_head(5);
  hear_lines(5, 1, lines - 1);
  hear_tail(5);
  EXPECT_THAT(asked(), IsEmpty());
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
}

TEST_F(ClientTest, ALostConfigurationIsSentAgain) {
  meet_and_start(config());
  pass(5s);
  EXPECT_THAT(said<PingConfig>(), SizeIs(testing::Ge(2U)));
  EXPECT_GE(client_.statistics().configs_repeated, 2U);
  hear_ping(5);
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
}

TEST_F(ClientTest, AnOldHeadInAnswerMeansThatTheConfigurationWasLost) {
  meet_and_start(config());
  const TimePoint transmitted = now_;
  hear_ping(5);
  ASSERT_THAT(said<PingConfig>(), SizeIs(1));
  while (said<RetryRequest>().empty()) {
    pass(1ms);
    ASSERT_LT(now_, 5s);
  }
  hear_head(5, transmitted, true);
  EXPECT_THAT(said<PingConfig>(), SizeIs(1));
  hear_head(5, transmitted, true);  // the answer to the second copy of the request
  EXPECT_THAT(said<PingConfig>(), IsEmpty());
  EXPECT_EQ(client_.statistics().pings_complete, 1U);
}

TEST_F(ClientTest, APingOfWhichNothingArrivedIsRepairedAndNotPingedAgain) {
  meet_and_start(config(), 1);
  const TimePoint transmitted = now_;
  while (said<RetryRequest>().empty()) {
    pass(1ms);
    ASSERT_LT(now_, 5s);
  }
  hear_head(5, transmitted, true);
  hear_lines(5, 0, lines, true);
  hear_tail(5, true);
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
  EXPECT_EQ(client_.statistics().configs_sent, 1U);
}

TEST_F(ClientTest, AHeadThatComesVeryLateStillSavesThePing) {
  meet_and_start(config(), 1);
  const TimePoint transmitted = now_;
  hear_lines(5, 0, lines);
  hear_tail(5);
  while (client_.statistics().pings_abandoned == 0) {
    pass(1ms);
    ASSERT_LT(now_, 5s);
  }
  pass(1ms);
  hear_head(5, transmitted, true);
  hear_tail(5, true);
  hear_lines(5, 0, lines, true);
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
  EXPECT_EQ(client_.statistics().configs_sent, 1U);
}

TEST_F(ClientTest, APingThatLacksOnlyItsTailIsDeliveredWhenTheNextBegins) {
  meet_and_start(config());
  hear_head(5);
  hear_lines(5, 0, lines);
  hear_line(6, 0);  // the head received the configuration twice
  const auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_EQ(pings[0].head.ping_id, 5);
  EXPECT_EQ(client_.statistics().pings_abandoned, 0U);
}

TEST_F(ClientTest, CanStartAgainAfterAStop) {
  meet_and_start(config(RunMode::continuous), 1);
  hear_ping(5);
  ASSERT_TRUE(client_.finished());
  static_cast<void>(client_.take_outgoing());
  client_.start(now_, config(), 1);
  client_.advance(now_);
  EXPECT_THAT(said<PingConfig>(), SizeIs(1));
  EXPECT_FALSE(client_.finished());
  pass(1500ms);
  EXPECT_THAT(said<StatusRequest>(), SizeIs(testing::Ge(1U)));
}

TEST_F(ClientTest, AHeadThatTakesItsTimeIsNotTakenForSilent) {
  meet_and_start(config(RunMode::continuous));  // requests 10 pings per second
  for (int id = 0; id < 5; ++id) {
    hear_ping(id);
    pass(1500ms);
    receive(status());
  }
  EXPECT_LE(client_.statistics().configs_sent, 2U);
}

TEST_F(ClientTest, ASecondPingToARepeatedConfigurationIsLetPass) {
  meet_and_start(config());
  pass(1100ms);
  ASSERT_EQ(client_.statistics().configs_sent, 2U);
  hear_ping(5);
  static_cast<void>(client_.take_outgoing());
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
  pass(5ms);
  hear_ping(6);  // the head received the first configuration too
  EXPECT_THAT(client_.take_pings(), IsEmpty());
  EXPECT_EQ(client_.statistics().pings_unrequested, 1U);
  EXPECT_THAT(said<PingConfig>(), SizeIs(1));  // the next one waited for the end of ping 6
  hear_ping(7);
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
}

TEST_F(ClientTest, WhatWasPingedBeforeTheConfigurationLeftIsNoAnswer) {
  now_ = 2s;
  meet_and_start(config(), 1);
  // An earlier client requested this ping and ended. The head is still sending it.
  hear_head(9, now_ - 500ms);
  hear_lines(9, 0, 20);
  hear_lines(9, 25, 15);
  EXPECT_THAT(asked(), IsEmpty());
  hear_tail(9);
  EXPECT_THAT(client_.take_pings(), IsEmpty());
  hear_ping(10);
  const auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_EQ(pings[0].head.ping_id, 10);
  EXPECT_EQ(client_.statistics().configs_sent, 1U);
}

TEST_F(ClientTest, DuplicatesAndDisorderDoNoHarm) {
  meet_and_start(config());
  hear_line(5, 1);
  hear_head(5);
  hear_head(5);
  hear_line(5, 0);
  for (int number = 2; number < lines; number += 2) {
    hear_line(5, number + 1);
    hear_line(5, number);
    hear_line(5, number);
  }
  hear_tail(5);
  hear_tail(5);
  hear_tail(5, true);
  hear_head(5, 1ms, true);
  hear_line(5, 3, true);
  const auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_EQ(pings[0].samples.u8, image(5));
  hear_ping(6);
  EXPECT_THAT(client_.take_pings(), SizeIs(1));
}

TEST_F(ClientTest, ALineThatNeverComesEndsThePingIncomplete) {
  meet_and_start(config(), 1);
  hear_head(5);
  hear_lines(5, 0, 10);
  hear_lines(5, 11, lines - 11);
  hear_tail(5);
  pass(2s);
  const auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_EQ(pings[0].lines_lost, 1);
  EXPECT_EQ(client_.statistics().pings_incomplete, 1U);
  EXPECT_EQ(client_.statistics().lines_missing, 1U);
  EXPECT_TRUE(client_.finished());
}

TEST_F(ClientTest, AHeadThatWasStartedAgainIsConfiguredAgain) {
  meet_and_start(config());
  now_ = 10s;
  receive(status());
  static_cast<void>(client_.take_outgoing());
  Status fresh = status();
  fresh.clock_us = 1'000;
  now_ += 6s;
  receive(fresh);
  EXPECT_EQ(client_.statistics().reboots, 1U);
  EXPECT_THAT(said<PingConfig>(), SizeIs(1));
}

// ---- Continuous ----

TEST_F(ClientTest, ContinuousPingsNeedOneConfigurationAndAreStoppedAtTheEnd) {
  meet_and_start(config(RunMode::continuous), 3);
  for (int id = 254; id < 257; ++id) {
    hear_ping(id & 0xFF);
    pass(100ms);
  }
  EXPECT_THAT(client_.take_pings(), SizeIs(3));
  EXPECT_EQ(client_.statistics().configs_sent, 1U);
  EXPECT_TRUE(client_.finished());
  EXPECT_THAT(said<GoingOffline>(), SizeIs(2));
  pass(10s);
  EXPECT_THAT(client_.take_outgoing(), IsEmpty());
}

TEST_F(ClientTest, LinesOfAnUnknownPingAskForItsHead) {
  meet_and_start(config(RunMode::continuous));
  hear_ping(5);
  pass(95ms);
  const TimePoint transmitted = now_;
  hear_lines(6, 0, 20);
  pass(3ms);
  EXPECT_THAT(asked(), ElementsAre("head"));
  hear_lines(6, 20, 20);
  hear_tail(6);
  hear_head(6, transmitted, true);
  const auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(2));
  EXPECT_EQ(pings[1].samples.u8, image(6));
}

TEST_F(ClientTest, APingThatHasLostLinesAsksAheadSoThatTheHeadHoldsItsNext) {
  meet_and_start(config(RunMode::continuous));
  hear_head(5);
  hear_lines(5, 1, lines - 10);
  EXPECT_THAT(asked(), IsEmpty());
  hear_lines(5, lines - 9, 5);
  EXPECT_THAT(asked(), ElementsAre("tail"));
}

TEST_F(ClientTest, ANextPingEndsAnIncompleteOneButLetsItsStragglersIn) {
  meet_and_start(config(RunMode::continuous));
  hear_head(5);
  hear_lines(5, 0, lines - 2);
  hear_head(6);
  hear_line(5, lines - 1);
  hear_line(6, 0);
  hear_line(5, lines - 2, true);
  auto pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_TRUE(pings[0].complete());
  hear_lines(6, 1, 5);
  hear_head(7);
  pass(20ms);
  pings = client_.take_pings();
  ASSERT_THAT(pings, SizeIs(1));
  EXPECT_EQ(pings[0].lines_lost, lines - 6);
}

TEST_F(ClientTest, SkippedIdsAreMissedPings) {
  meet_and_start(config(RunMode::continuous));
  hear_ping(255);
  hear_ping(2);
  EXPECT_EQ(client_.statistics().pings_missed, 2U);  // pings 0 and 1
}

TEST_F(ClientTest, AProgrammeThatFallsSilentIsSentAgain) {
  meet_and_start(config(RunMode::continuous));
  hear_ping(5);
  pass(3s);
  EXPECT_THAT(said<PingConfig>(), SizeIs(testing::Ge(1U)));
}

TEST_F(ClientTest, StopSilencesTheClient) {
  meet_and_start(config(RunMode::continuous));
  hear_head(5);
  hear_lines(5, 0, 3);
  client_.stop();
  client_.advance(now_);
  EXPECT_THAT(said<GoingOffline>(), SizeIs(2));
  hear_lines(5, 10, 3);
  receive(status());
  pass(10s);
  EXPECT_THAT(client_.take_outgoing(), IsEmpty());
  EXPECT_TRUE(client_.finished());
}

}  // namespace
}  // namespace sonard::gemini
