// SPDX-License-Identifier: Apache-2.0
// Log lines that clients cause: their rate is limited, and dropped lines are counted in the log.
#include "server/program_log/peer_log.hpp"

#include <memory>
#include <new>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

/// A value for whose text there is no memory.
struct TooLong {};
template <>
struct fmt::formatter<TooLong> {
  constexpr auto parse(format_parse_context& context) { return context.begin(); }
  static format_context::iterator format(const TooLong&, format_context&) { throw std::bad_alloc(); }
};

namespace sonard::server {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

struct StandingClock : Clock {
  TimePoint time = 100s;
  TimePoint now() const override { return time; }
};

struct Lines final : spdlog::sinks::base_sink<std::mutex> {
  std::vector<std::string> texts;
  void sink_it_(const spdlog::details::log_msg& message) override {
    texts.emplace_back(message.payload.data(), message.payload.size());
  }
  void flush_() override {}
};

struct PeerLogTest : testing::Test {
  std::shared_ptr<Lines> lines = std::make_shared<Lines>();
  std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
  StandingClock clock;
  PeerLog log{clock};

  PeerLogTest() { spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", lines)); }
  ~PeerLogTest() override { spdlog::set_default_logger(before); }
};

TEST_F(PeerLogTest, LetsABurstThroughAndLeavesTheRestOut) {
  for (int i = 0; i < 1000; ++i) {
    log.info("client {} came", i);
  }
  ASSERT_EQ(lines->texts.size(), static_cast<std::size_t>(PeerLog::burst));
  EXPECT_EQ(lines->texts.back(), "client 9 came");
}

TEST_F(PeerLogTest, ALineWithoutMemoryIsDroppedAndCounted) {
  log.warn("client {}", TooLong());
  log.error("{}", TooLong());
  EXPECT_TRUE(lines->texts.empty());
  log.info("next");
  log.info("last");
  EXPECT_THAT(lines->texts,
              testing::ElementsAre(
                  "next (2 earlier lines were dropped: too many in a short time, or out of memory)", "last"));
}

TEST_F(PeerLogTest, SaysWithTheNextLineHowManyAreMissing) {
  for (int i = 0; i < 30; ++i) {
    log.info("{}", i);
  }
  clock.time += PeerLog::refill;
  log.warn("again");
  log.warn("again");
  ASSERT_EQ(lines->texts.size(), 11U);
  EXPECT_THAT(lines->texts.back(), HasSubstr("again (20 earlier lines"));
}

TEST_F(PeerLogTest, OneLineForEachRefillGoesOnForEver) {
  for (int i = 0; i < 1000; ++i) {
    clock.time += std::chrono::nanoseconds{PeerLog::refill} / 4;
    log.info("{}", i);
  }
  EXPECT_NEAR(static_cast<double>(lines->texts.size()), 10 + 250, 2);
}

TEST_F(PeerLogTest, TheFirstLineOfEachReasonComesThrough) {
  for (int i = 0; i < 100; ++i) {
    log.warn("datagram {} is too short", i);
  }
  log.warn("the checksum of datagram {} is wrong", 100);
  log.warn("client 10.0.0.7:{} is not in the allow list", 4000);
  log.warn("the checksum of datagram {} is wrong", 101);
  ASSERT_EQ(lines->texts.size(), 12U);
  EXPECT_THAT(lines->texts[10],
              testing::StartsWith("the checksum of datagram 100 is wrong (90 earlier lines"));
  EXPECT_EQ(lines->texts[11], "client 10.0.0.7:4000 is not in the allow list");
}

TEST_F(PeerLogTest, RestFillsItUpAndNoFurther) {
  for (int i = 0; i < 10; ++i) {
    log.info("{}", i);
  }
  clock.time += 24h;
  lines->texts.clear();
  for (int i = 0; i < 50; ++i) {
    log.info("{}", i);
  }
  EXPECT_EQ(lines->texts.size(), 10U);
  EXPECT_THAT(lines->texts.back(), Not(HasSubstr("left out")));
}

}  // namespace
}  // namespace sonard::server
