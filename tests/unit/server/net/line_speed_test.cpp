// SPDX-License-Identifier: Apache-2.0
// Time that bytes take on the line, with a stepped clock.
#include <algorithm>

#include "tests/unit/server/net/link_fixture.hpp"

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

/// A line of one byte per millisecond, with one client.
class LineSpeed : public LinkTest {
 protected:
  LineSpeed() {
    open({{any_tcp}, {}, {}, 10'000}, stepped_);
    client_ = std::make_unique<Client>(tcp_client());
    EXPECT_TRUE(run_until_connections(1));
  }

  /// Writes bytes as the client and waits until the link has read them.
  void write(const Bytes& bytes) {
    const std::uint64_t before = link_->counters().ports.bytes_in;
    client_->write(bytes);
    ASSERT_TRUE(run_until([&] { return link_->counters().ports.bytes_in == before + bytes.size(); }));
  }
  void step(TimePoint by) {
    stepped_.time += by;
    for (int i = 0; i < 100; ++i) {
      io_.poll_one();
      io_.restart();
    }
  }

  SteppedClock stepped_;
  std::unique_ptr<Client> client_;
};

TEST_F(LineSpeed, AFrameArrivesWholeWhenItsLastByteWould) {
  link_->send(alive);
  step(milliseconds{22} - TimePoint{1});
  EXPECT_THAT(client_->heard(), IsEmpty());
  EXPECT_EQ(link_->counters().ports.bytes_out, 0U);
  step(TimePoint{1});
  ASSERT_TRUE(run_until([&] { return client_->readable() > 0; }));
  EXPECT_EQ(client_->read_once(), alive);
}

TEST_F(LineSpeed, FramesFollowEachOther) {
  link_->send(numbered_frame(1, 100));
  link_->send(numbered_frame(2, 100));
  step(milliseconds{100});
  EXPECT_EQ(link_->counters().ports.bytes_out, 100U);
  step(milliseconds{99});
  EXPECT_EQ(link_->counters().ports.bytes_out, 100U);
  step(milliseconds{1});
  EXPECT_EQ(link_->counters().ports.bytes_out, 200U);
  ASSERT_TRUE(run_until([&] { return client_->heard().size() == 200; }));
  EXPECT_THAT(frame_numbers(client_->heard(), 100), ElementsAre(1, 2));
}

TEST_F(LineSpeed, ACommandTakesItsTimeToo) {
  write(send_version);
  step(milliseconds{14} - TimePoint{1});
  EXPECT_THAT(heard_, IsEmpty());
  step(TimePoint{1});
  EXPECT_EQ(heard_, send_version);
}

TEST_F(LineSpeed, TheDirectionsDoNotWaitForEachOther) {
  link_->send(numbered_frame(1, 1000));
  write(send_version);
  step(milliseconds{14});
  EXPECT_EQ(heard_, send_version);
}

TEST_F(LineSpeed, AClientLeavesAfterWhatItSaid) {
  write(send_version);
  client_->close();
  ASSERT_TRUE(run_until([&] { return !link_->connected(); }));
  step(milliseconds{14} - TimePoint{1});
  EXPECT_THAT(left_, IsEmpty());
  step(TimePoint{1});
  EXPECT_EQ(heard_, send_version);
  EXPECT_EQ(left_.size(), 1U);
}

TEST_F(LineSpeed, WhatIsOnItsWayToNobodyIsDiscarded) {
  link_->send(numbered_frame(1, 100));
  client_->close();
  ASSERT_TRUE(run_until_left(1));
  EXPECT_EQ(link_->counters().frames_unheard, 1U);
  Client next = tcp_client();
  ASSERT_TRUE(run_until_connections(2));
  step(milliseconds{1000});
  link_->send(alive);
  step(milliseconds{22});
  EXPECT_TRUE(run_until_hears(next, alive));
}

TEST_F(LineSpeed, WhatTheLineCannotCarryIsDroppedWhole) {
  for (int i = 0; i < 20; ++i) {
    link_->send(numbered_frame(i, 1000));
  }
  EXPECT_EQ(link_->counters().frames_overflowed, 12U) << "8192 bytes may wait";
  step(milliseconds{8000});
  ASSERT_TRUE(run_until([&] { return client_->heard().size() == 8000; }));
  EXPECT_THAT(frame_numbers(client_->heard(), 1000), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  link_->send(numbered_frame(99, 1000));
  step(milliseconds{1000});
  ASSERT_TRUE(run_until([&] { return client_->heard().size() == 9000; }));
}

TEST_F(LineSpeed, AClientThatSaysTooMuchLosesIt) {
  write(Bytes(20'000, 0x55));
  const std::uint64_t overrun = link_->counters().bytes_overrun;
  EXPECT_GE(overrun, 20'000U - 8192U);
  step(milliseconds{8192});
  EXPECT_EQ(heard_.size() + overrun, 20'000U);
  heard_.clear();
  write(send_version);
  step(milliseconds{14});
  EXPECT_EQ(heard_, send_version);
}

// Callbacks that are due run one after the other, and never inside each other.
TEST_F(LineSpeed, CallbacksThatAnswerDoNotPileUp) {
  int depth = 0;
  int deepest = 0;
  link_ = std::make_unique<SerialLink>(io_, SerialLinkConfig{{}, {any_udp}, {}, 10'000}, stepped_);
  link_->start(
      [&](std::span<const std::uint8_t> bytes, const std::string&) {
        deepest = std::max(deepest, ++depth);
        heard_.insert(heard_.end(), bytes.begin(), bytes.end());
        link_->send(alive);
        --depth;
      },
      [](const std::string&) {});
  Client client = udp_client();
  for (std::uint8_t i = 0; i < 3; ++i) {
    client.write(Bytes{i});
  }
  ASSERT_TRUE(run_until([&] { return link_->counters().ports.bytes_in == 3; }));
  step(milliseconds{1000});
  EXPECT_EQ(heard_, (Bytes{0, 1, 2}));
  EXPECT_EQ(deepest, 1);
}

TEST_F(LineSpeed, MayBeDestroyedByACallbackThatASendHasCaused) {
  link_ = std::make_unique<SerialLink>(io_, SerialLinkConfig{{}, {any_udp}, {}, 10'000}, stepped_);
  link_->start([&](std::span<const std::uint8_t>, const std::string&) { link_.reset(); },
               [](const std::string&) {});
  Client client = udp_client();
  client.write(Bytes{1});
  ASSERT_TRUE(run_until([&] { return link_->counters().ports.bytes_in == 1; }));
  stepped_.time += milliseconds{1};
  link_->send(alive);
  EXPECT_EQ(link_, nullptr);
}

TEST_F(LinkTest, TheLineKeepsRealTime) {
  open({{any_tcp}, {}, {}, 9600});
  Client client = tcp_client();
  ASSERT_TRUE(run_until_connections(1));
  const auto sent = std::chrono::steady_clock::now();
  for (int i = 0; i < 10; ++i) {
    link_->send(alive);
  }
  ASSERT_TRUE(run_until([&] { return client.heard().size() == 10 * alive.size(); }));
  // 220 bytes of ten bits at 9600 bits per second.
  EXPECT_GE(std::chrono::steady_clock::now() - sent, std::chrono::microseconds{229'166});
}

}  // namespace
}  // namespace sonard::server
