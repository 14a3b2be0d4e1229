// SPDX-License-Identifier: Apache-2.0
// Pings of a log that heads receive, and the end of playback.
#include "server/replay/log_playback.hpp"

#include <chrono>
#include <memory>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "renderer/errors.hpp"
#include "renderer/ping.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t ms = 1'000'000;

RecordedSettings settings(int bins, int beams) {
  RecordedSettings settings;
  settings.bins = bins;
  settings.beams = beams;
  settings.bin_m = 0.5;
  settings.sound_speed_mps = 1480.0;
  settings.sound_speed_from_config = false;
  settings.gain_percent = 31.5;
  return settings;
}

LoggedHead fan(const std::vector<std::int64_t>& times_ns) {
  LoggedHead head;
  head.device_id = 513;
  for (const std::int64_t time_ns : times_ns) {
    head.pings.push_back(
        {.time_ns = time_ns, .settings = settings(3, 2), .wire = {}, .place = 10 + head.pings.size()});
  }
  return head;
}

LoggedHead scan() {
  LoggedHead head;
  head.name = "mast";
  head.scanning = true;
  head.pings.push_back({.time_ns = 5 * ms,
                        .settings = settings(4, 1),
                        .bearing_rad = 0.75,
                        .bits_per_bin = 4,
                        .wire = {1, 2, 3},
                        .place = 90});
  return head;
}

/// The job that a device makes of a fed ping.
PingJob answering(const ReplayedPing& ping, TimePoint transmit_time) {
  PingJob job;
  job.number = 77;
  job.transmit_time = transmit_time;
  job.record = ping.record;
  return job;
}

TEST(LogPlayback, FeedsPingsAsTheyWereRecorded) {
  const LoggedHead bow = fan({1000 * ms, 1100 * ms});
  const LoggedHead mast = scan();
  LogPlayback playback({{"bow", &bow}, {"mast", &mast}}, {.as_asked = true}, 0ns);
  const auto first = playback.next_ping(0, 1s);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->record, 0U);
  EXPECT_EQ(first->settings, settings(3, 2));
  EXPECT_EQ(first->bits_per_bin, 8);
  EXPECT_TRUE(first->wire.empty());
  EXPECT_EQ(first->due, std::nullopt);
  EXPECT_EQ(playback.next_ping(0, 1s)->record, 0U) << "it has not begun";
  playback.started(0, answering(*first, 1s));
  EXPECT_EQ(playback.next_ping(0, 1s)->record, 1U);

  const auto line = playback.next_ping(1, 1s);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->record, 0U) << "each head counts its own";
  EXPECT_EQ(line->settings, settings(4, 1));
  EXPECT_EQ(line->bearing_rad, 0.75);
  EXPECT_EQ(line->bits_per_bin, 4);
  EXPECT_EQ(line->wire, (std::vector<std::uint8_t>{1, 2, 3}));
  playback.started(1, answering(*line, 1s));
  EXPECT_FALSE(playback.next_ping(1, 1s));
}

TEST(LogPlayback, SaysWhenPingsAreDue) {
  const LoggedHead bow = fan({1000 * ms, 1100 * ms, 1300 * ms});
  LogPlayback playback({{"bow", &bow}}, {}, 0ns);
  EXPECT_EQ(playback.next_ping(0, 7s)->due, std::nullopt);
  playback.started(0, answering(*playback.next_ping(0, 7s), 7s));
  EXPECT_EQ(playback.next_ping(0, 7s)->due, 7100ms);
  playback.started(0, answering(*playback.next_ping(0, 7s), 7100ms));
  EXPECT_EQ(playback.next_ping(0, 7100ms)->due, 7300ms);
}

TEST(LogPlayback, IsOverWhenTheLastPingHasEndedAndNobodyAsksAgain) {
  const LoggedHead bow = fan({0, 100 * ms});
  LogPlayback playback({{"bow", &bow}}, {}, 0ns);
  for (std::uint64_t ping = 0; ping < 2; ++ping) {
    EXPECT_FALSE(playback.finished(1s));
    playback.started(0, answering(*playback.next_ping(0, 1s), 1s + 100ms * ping));
    playback.progress(0, 1s + 100ms * ping, {.sent = ping, .ended = ping, .messages = 10 * ping});
  }
  EXPECT_FALSE(playback.next_ping(0, 1200ms));
  EXPECT_FALSE(playback.finished(30s)) << "the last ping is on its way, however long that takes";
  playback.progress(0, 30s, {.sent = 2, .ended = 2, .messages = 20});
  EXPECT_FALSE(playback.finished(30s + LogPlayback::linger - 1ns));
  playback.progress(0, 31s, {.sent = 2, .ended = 2, .messages = 20});
  EXPECT_TRUE(playback.finished(30s + LogPlayback::linger)) << "steps in which nothing is sent do not count";
  playback.progress(0, 31s, {.sent = 2, .ended = 2, .messages = 21});
  EXPECT_FALSE(playback.finished(31s + LogPlayback::linger - 1ns)) << "a message was sent again";
  EXPECT_TRUE(playback.finished(31s + LogPlayback::linger));
}

TEST(LogPlayback, APingThatFailedHasEndedToo) {
  const LoggedHead bow = fan({0});
  LogPlayback playback({{"bow", &bow}}, {}, 0ns);
  playback.started(0, answering(*playback.next_ping(0, 1s), 1s));
  playback.progress(0, 1s, {});
  EXPECT_FALSE(playback.finished(9s));
  playback.progress(0, 2s, {.sent = 0, .ended = 1, .messages = 0});
  EXPECT_TRUE(playback.finished(2s + LogPlayback::linger));
}

TEST(LogPlayback, WaitsForAllHeads) {
  const LoggedHead bow = fan({0});
  const LoggedHead mast = scan();
  LogPlayback playback({{"bow", &bow}, {"mast", &mast}}, {}, 0ns);
  playback.started(0, answering(*playback.next_ping(0, 1s), 1s));
  playback.progress(0, 1s, {.sent = 1, .ended = 1, .messages = 5});
  EXPECT_FALSE(playback.finished(60s));
  playback.started(1, answering(*playback.next_ping(1, 61s), 61s));
  playback.progress(1, 61s, {.sent = 1, .ended = 1, .messages = 1});
  EXPECT_FALSE(playback.finished(62s));
  EXPECT_TRUE(playback.finished(63s));
}

struct LoggedDifferences : testing::Test {
  std::ostringstream text;
  std::shared_ptr<spdlog::logger> before = spdlog::default_logger();

  LoggedDifferences() {
    auto logger =
        std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::ostream_sink_mt>(text));
    logger->set_pattern("%l %v");
    spdlog::set_default_logger(logger);
  }
  ~LoggedDifferences() override { spdlog::set_default_logger(before); }

  std::string taken() { return std::exchange(text, {}).str(); }
};

TEST_F(LoggedDifferences, EachKindIsSaidOnceAndCounted) {
  const LoggedHead bow = fan({0, 1, 2});
  LogPlayback playback({{"bow", &bow}}, {.as_asked = true}, 0ns);
  const auto begin = [&](const std::vector<Difference>& differences) {
    PingJob job = answering(*playback.next_ping(0, 1s), 1s);
    job.differences = differences;
    playback.started(0, job);
    return taken();
  };
  const Difference range{"range", "range 20.00 m requested, 4.00 m sent"};
  EXPECT_EQ(begin({range}),
            "warning head=bow: differs from the recording: range 20.00 m requested, 4.00 m sent\n");
  EXPECT_EQ(begin({{"range", "range 30.00 m requested, 4.00 m sent"}}), "") << "it is of the same kind";
  EXPECT_EQ(begin({range, {"16_bit", "16 bits requested, 8 bits sent"}}),
            "warning head=bow: differs from the recording: 16 bits requested, 8 bits sent\n");
  playback.log_totals();
  EXPECT_EQ(taken(), "info head=bow: pings that differ from the request: range=3 16_bit=1\n");
}

TEST_F(LoggedDifferences, OfNoneNothingIsSaid) {
  const LoggedHead bow = fan({0});
  LogPlayback playback({{"bow", &bow}}, {.as_asked = true}, 0ns);
  playback.started(0, answering(*playback.next_ping(0, 1s), 1s));
  playback.log_totals();
  EXPECT_EQ(taken(), "");
}

// ---- The recording instead of the renderer

/// A recording in which every sample of a ping equals the ping's place.
class PlacesAsSamples final : public LogReader {
 public:
  std::vector<std::uint8_t> samples(const LoggedPing& ping) const override {
    if (ping.settings.beams == 1) {
      throw Error(ErrorKind::configuration, "a.mcap: a ping cannot be read");
    }
    const int count = ping.settings.bins * ping.settings.beams;
    return std::vector<std::uint8_t>(static_cast<std::size_t>(count), static_cast<std::uint8_t>(ping.place));
  }
  std::vector<std::string> problems() const override { return {}; }
  bool closed() const override { return true; }
};

TEST(LogRenderer, HandsOutTheSamplesOfTheRecordThatAPingAnswers) {
  const LoggedHead bow = fan({0, 1, 2});
  const LoggedHead stern = fan({0});
  const PlacesAsSamples recording;
  const auto renderer = make_log_renderer(recording, {{"bow", &bow}, {"stern", &stern}})();
  render::PingRequest request;
  request.ping_number = 2;
  const render::PingSamples samples = renderer->render_ping(request, 0);
  EXPECT_EQ(samples.bins, 3);
  EXPECT_EQ(samples.beams, 2);
  EXPECT_EQ(samples.u8, std::vector<std::uint8_t>(6, 12));
  EXPECT_TRUE(samples.u16.empty());
  request.ping_number = 0;
  EXPECT_EQ(renderer->render_ping(request, 1).u8, std::vector<std::uint8_t>(6, 10));
}

TEST(LogRenderer, WhatCannotBeReadIsAPingThatCannotBeMade) {
  const LoggedHead mast = scan();
  const PlacesAsSamples recording;
  const auto renderer = make_log_renderer(recording, {{"mast", &mast}})();
  EXPECT_THROW(renderer->render_ping({}, 0), render::RequestError);
}

}  // namespace
}  // namespace sonard::server
