// SPDX-License-Identifier: Apache-2.0
// Rates and gaps calculated by hand, and captures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/gemini/codec.hpp"
#include "protocol/micron/codec.hpp"
#include "protocol/pcapng/blocks.hpp"
#include "server/devices/types/types.hpp"
#include "server/info/info_text.hpp"
#include "server/logs/log_summary.hpp"
#include "tests/unit/server/logs/temporary_log.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t ms = 1'000'000;

TEST(PingRate, MedianAndGaps) {
  // The intervals are 100, 100, 200, 201, 100, 500 ms. Their median is 200 ms, so only 500 ms is a gap.
  const PingRate rate = ping_rate({0, 100 * ms, 200 * ms, 400 * ms, 601 * ms, 701 * ms, 1201 * ms});
  EXPECT_DOUBLE_EQ(rate.median_interval_s, 0.2);
  EXPECT_DOUBLE_EQ(rate.rate_hz(), 5.0);
  EXPECT_EQ(rate.gaps, 1U);
  EXPECT_DOUBLE_EQ(rate.longest_gap_s, 0.5);
}

TEST(PingRate, TwiceTheMedianIsNoGap) {
  EXPECT_EQ(ping_rate({0, 100 * ms, 200 * ms, 300 * ms, 500 * ms}).gaps, 0U);
}

TEST(PingRate, OnePingHasNone) {
  EXPECT_EQ(ping_rate({5}).rate_hz(), 0.0);
  EXPECT_EQ(ping_rate({}).rate_hz(), 0.0);
}

TEST(IsoTime, AlsoBefore1970) {
  EXPECT_EQ(iso_time(1'000'000'000'123'999'999, true), "2001-09-09T01:46:40.123Z");
  EXPECT_EQ(iso_time(-1, false), "1969-12-31T23:59:59.999");
}

TEST(InfoJson, TextOfLogsIsEscaped) {
  LogSummary log;
  log.path = "a\"b\\c\nd";
  EXPECT_NE(info_json(log, 0).find(R"("file":"a\"b\\c\nd")"), std::string::npos);
}

/// The text and JSON for one head of a log.
struct Said {
  std::string text, json;
};

Said said_of(LogKind kind, const std::string& name, const std::string& device, std::uint16_t id,
             bool scanning) {
  LogSummary log;
  log.kind = kind;
  HeadSummary& head = head_of(log, name, device, id, scanning);
  RecordedSettings settings;
  settings.bins = 400;
  settings.beams = scanning ? 1 : 256;
  settings.bin_m = 0.025;
  add_ping(head, 0, settings);
  return {info_text(log, 0), info_json(log, 0)};
}

TEST(InfoText, HeadsHaveTheTitleOfTheirKind) {
  const Said bow = said_of(LogKind::mcap, "bow", "gemini_720i", 513, false);
  EXPECT_THAT(bow.text, HasSubstr("\nhead     Gemini 720i 513 'bow': 1 pings\n"));
  EXPECT_THAT(bow.text, HasSubstr(" 1x 400 range bins of 256 beams, range 10.00 m"));
  EXPECT_THAT(bow.json, HasSubstr(R"([{"type":"gemini_720i","scanning":false,"name":"bow","id":513,)"));
  const Said stern = said_of(LogKind::mcap, "stern", "micron", 2, true);
  EXPECT_THAT(stern.text, HasSubstr("\nhead     Micron 2 'stern': 1 lines\n"));
  EXPECT_THAT(stern.text, HasSubstr(" 1x 400 bins, range 10.00 m"));
  EXPECT_THAT(stern.json, HasSubstr(R"([{"type":"micron","scanning":true,"name":"stern","id":2,)"));
}

TEST(InfoText, WhatNobodyKnowsIsASonar) {
  const Said fan = said_of(LogKind::mcap, "bow", "", 600, false);
  EXPECT_THAT(fan.text, HasSubstr("\nhead     multibeam sonar 600 'bow': 1 pings\n"));
  EXPECT_THAT(fan.json, HasSubstr(R"([{"type":null,"scanning":false,)"));
  const Said line = said_of(LogKind::mcap, "", "", 2, true);
  EXPECT_THAT(line.text, HasSubstr("\nhead     scanning sonar 2: 1 lines\n"));
  EXPECT_THAT(line.json, HasSubstr(R"([{"type":null,"scanning":true,)"));
  const Said other = said_of(LogKind::mcap, "bow", "other_900", 600, false);
  EXPECT_THAT(other.text, HasSubstr("\nhead     multibeam sonar 600 'bow': 1 pings\n"));
  EXPECT_THAT(other.json, HasSubstr(R"([{"type":"other_900","scanning":false,)")) << "the log knows";
}

TEST(InfoText, TheFormatOfALogSaysWhoseItIs) {
  for (const LogKind kind : {LogKind::glf, LogKind::dat}) {
    const Said said = said_of(kind, "", "", 600, false);
    EXPECT_THAT(said.text, HasSubstr("\nhead     Gemini 720i 600: 1 pings\n"));
    EXPECT_THAT(said.json, HasSubstr(R"([{"type":"gemini_720i","scanning":false,"name":"",)"));
  }
}

TEST(Capture, PingsAreCountedByTheirHeads) {
  pcapng::Writer writer("test");
  const std::uint32_t bow = writer.add_interface("bow");
  const pcapng::Endpoint head_end{0x7F000002, 52901};
  const pcapng::Endpoint client{0x7F000001, 52900};
  const auto add = [&](std::uint64_t time_ns, const gemini::Report& report) {
    const auto bytes = gemini::encode(report);
    writer.add_packet(bow, time_ns, pcapng::udp_packet(head_end, client, bytes));
  };
  gemini::PingHead head;
  head.header.sonar_id = 600;
  head.ext_mode = 0x0004;
  head.end_range = 200;
  head.range_compression = 1;
  head.sound_speed_used = 0x8000 | 15000;
  for (std::uint64_t ping = 0; ping < 3; ++ping) {
    head.ping_id = static_cast<std::uint16_t>(ping);
    add(1'000'000'000 + ping * 100'000'000, head);
    gemini::PingHead again = head;
    again.ping_id |= 0x0100;  // a repetition of this head
    add(1'000'000'000 + ping * 100'000'000 + 1000, again);
    add(1'000'000'000 + ping * 100'000'000 + 2000, gemini::PingTail{});
  }
  const auto whole = writer.take();
  const test::TemporaryLog temporary(".pcapng", std::span(whole).first(whole.size() - 3));
  const LogSummary summary = summarise(LogFile(temporary.path()), &ping_in, &open_packet_log);
  ASSERT_EQ(summary.heads.size(), 1U);
  EXPECT_EQ(summary.heads[0].id, 600);
  EXPECT_EQ(summary.heads[0].type, "gemini_720i");
  EXPECT_FALSE(summary.heads[0].scanning);
  EXPECT_EQ(summary.heads[0].pings(), 3U);
  const RecordedSettings& settings = summary.heads[0].settings.at(0).settings;
  EXPECT_EQ(settings.bins, 100);
  EXPECT_NEAR(settings.range_m(), 200 * 1500.0 / (2 * 90422.0), 1e-9);
  EXPECT_EQ(summary.other_records,
            (std::vector<std::pair<std::string, std::uint64_t>>{{"interfaces", 1}, {"UDP packets", 8}}));
  EXPECT_EQ(summary.problems.size(), 1U) << "the last packet is cut";
}

/// A capture of datagrams between a head and its client, one every 0.1 s.
std::vector<std::uint8_t> capture_of(const std::vector<std::vector<std::uint8_t>>& datagrams) {
  pcapng::Writer writer("test");
  const std::uint32_t lan = writer.add_interface("lan");
  std::uint64_t time_ns = 1'000'000'000;
  for (const std::vector<std::uint8_t>& bytes : datagrams) {
    writer.add_packet(lan, time_ns, pcapng::udp_packet({0x7F000002, 52901}, {0x7F000001, 52900}, bytes));
    time_ns += 100'000'000;
  }
  return writer.take();
}

TEST(Capture, HasThePingsThatAKindOfDeviceFinds) {
  // One byte is a ping of a multibeam head with this ID. Two bytes are a line. Other lengths are no pings.
  const auto find = [](std::span<const std::uint8_t> datagram) -> std::optional<CapturedPing> {
    if (datagram.empty() || datagram.size() > 2) {
      return std::nullopt;
    }
    CapturedPing seen{datagram.size() == 1 ? "fan" : "line", datagram[0], {}};
    seen.settings.bins = 10;
    seen.settings.beams = datagram.size() == 1 ? 64 : 1;
    return seen;
  };
  const test::TemporaryLog temporary(".pcapng", capture_of({{7}, {7, 0}, {8}, {1, 2, 3}, {7}, {}}));
  const LogSummary summary = summarise(LogFile(temporary.path()), find, {});
  ASSERT_EQ(summary.heads.size(), 3U);
  EXPECT_EQ(summary.heads[0].type, "fan");
  EXPECT_EQ(summary.heads[0].id, 7);
  EXPECT_FALSE(summary.heads[0].scanning);
  EXPECT_THAT(summary.heads[0].times_ns, ElementsAre(1'000 * ms, 1'400 * ms));
  EXPECT_EQ(summary.heads[1].type, "line");
  EXPECT_EQ(summary.heads[1].id, 7);
  EXPECT_TRUE(summary.heads[1].scanning);
  EXPECT_EQ(summary.heads[1].pings(), 1U);
  EXPECT_EQ(summary.heads[2].id, 8);
  EXPECT_EQ(summary.heads[2].pings(), 1U);
  EXPECT_EQ(summary.other_records,
            (std::vector<std::pair<std::string, std::uint64_t>>{{"interfaces", 1}, {"UDP packets", 6}}));
}

TEST(Capture, KeepsDevicesOfOneIdApart) {
  const auto find = [](std::span<const std::uint8_t> datagram) -> std::optional<CapturedPing> {
    CapturedPing seen{datagram[0] == 1 ? "one" : "other", 7, {}};
    seen.settings.beams = 64;
    return seen;
  };
  const test::TemporaryLog temporary(".pcapng", capture_of({{1}, {2}, {1}}));
  const LogSummary summary = summarise(LogFile(temporary.path()), find, {});
  ASSERT_EQ(summary.heads.size(), 2U);
  EXPECT_EQ(summary.heads[0].type, "one");
  EXPECT_EQ(summary.heads[0].pings(), 2U);
  EXPECT_EQ(summary.heads[1].type, "other");
}

TEST(Capture, OfALineOfAMicronOnlyThePacketIsCounted) {
  micron::HeadData line;
  const std::vector<std::uint8_t> bins(100, 1);
  line.data = bins;
  const test::TemporaryLog temporary(".pcapng", capture_of({micron::encode(micron::Report{line})}));
  const LogSummary summary = summarise(LogFile(temporary.path()), &ping_in, &open_packet_log);
  EXPECT_TRUE(summary.heads.empty());
  EXPECT_EQ(summary.other_records,
            (std::vector<std::pair<std::string, std::uint64_t>>{{"interfaces", 1}, {"UDP packets", 1}}));
}

}  // namespace
}  // namespace sonard::server
