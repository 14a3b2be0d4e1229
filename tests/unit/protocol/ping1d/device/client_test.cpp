// SPDX-License-Identifier: Apache-2.0
// Our client against our head.
#include "protocol/ping1d/client.hpp"

#include "tests/unit/protocol/ping1d/device/bench.hpp"

namespace sonard::ping1d {
namespace {

/// A client and a head with a line between them.
class Session : public Bench {
 public:
  using Bench::Bench;
  Client client{0ns};
  bool deaf = false;

  void run_session(std::chrono::nanoseconds span) {
    for (const TimePoint end = now + span; now < end; run_for(1ms)) {
      for (; said_ < heard.size(); ++said_) {
        if (!deaf) {
          client.on_bytes(now, heard[said_].frame);
        }
      }
      client.advance(now);
      for (const Bytes& frame : client.take_outgoing()) {
        raw(frame);
      }
    }
  }

 private:
  std::size_t said_ = 0;
};

TEST(Ping1dClient, MeetsTheHeadAndTakesPings) {
  Session session;
  session.client.start(0ns, {SetPingEnable{1}, SetPingInterval{50}, SetModeAuto{0}, SetRange{0, 5000}}, 10);
  session.run_session(2s);
  EXPECT_EQ(session.client.information(), DeviceConfig{}.information);
  EXPECT_TRUE(session.client.finished());
  const auto pings = session.client.take_pings();
  ASSERT_EQ(pings.size(), 10U);
  for (std::size_t i = 0; i < pings.size(); ++i) {
    EXPECT_EQ(pings[i].measured.ping_number, pings[0].measured.ping_number + i);
    EXPECT_EQ(pings[i].profile.size(), 200U);
    EXPECT_NEAR(pings[i].measured.distance_mm, 2000, 1);
  }
  const std::size_t before = session.heard.size();
  session.run_session(1s);
  EXPECT_EQ(session.heard.size(), before) << "the stream has ended";
  EXPECT_EQ(session.client.statistics().pings_missed, 0U);
}

TEST(Ping1dClient, DropsCopiesAndLatePings) {
  Session session;
  session.client.start(0ns, {}, 0);
  session.run_session(1s);
  session.client.take_pings();
  const std::uint64_t missed = session.client.statistics().pings_missed;
  for (const std::uint32_t number : {100U, 103U, 102U, 103U, 104U, 1U}) {
    session.client.on_bytes(session.now, encode(Profile{{.ping_number = number}, {}}));
  }
  std::vector<std::uint32_t> numbers;
  for (const ReceivedPing& ping : session.client.take_pings()) {
    numbers.push_back(ping.measured.ping_number);
  }
  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{100, 103, 104, 1}))
      << "the last is of a head that has restarted";
  EXPECT_GT(session.client.statistics().pings_missed, missed + 1);
}

TEST(Ping1dClient, RequestsTheStreamAgainIfNoPingComes) {
  Session session;
  session.client.start(0ns, {}, 0);
  session.run_session(2s);
  session.command(GotoBootloader{}, client_b);
  session.run_session(10s);
  EXPECT_GE(session.client.statistics().timeouts, 2U);
  const auto before = session.client.statistics().pings;
  session.run_session(1s);
  EXPECT_GE(session.client.statistics().pings, before + 3);
}

TEST(Ping1dClient, TellsARefusal) {
  Session session;
  session.client.start(0ns, {SetModeAuto{1}, SetGainSetting{2}}, 0);
  session.run_session(1s);
  EXPECT_EQ(session.client.refusal(), (Nack{1005, "auto mode is on"}));
}

TEST(Ping1dClient, StopsEvenIfNobodyAnswers) {
  Session session;
  session.client.start(0ns, {}, 0);
  session.run_session(1s);
  session.deaf = true;
  session.client.stop(session.now);
  EXPECT_FALSE(session.client.finished());
  session.run_session(2s);
  EXPECT_TRUE(session.client.finished());
}

}  // namespace
}  // namespace sonard::ping1d
