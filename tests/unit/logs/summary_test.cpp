// SPDX-License-Identifier: Apache-2.0
// Rates and gaps by hand, and captures.
#include <gtest/gtest.h>

#include "protocol/gemini/codec.hpp"
#include "protocol/pcapng/blocks.hpp"
#include "server/info/info_text.hpp"
#include "server/logs/log_summary.hpp"
#include "tests/unit/logs/temporary_log.hpp"

namespace sonard::server {
namespace {

constexpr std::int64_t ms = 1'000'000;

TEST(PingRate, median_and_gaps) {
  // Intervals 100, 100, 200, 201, 100, 500: the median is 200 of the six, so only 500 is a gap.
  const PingRate rate = ping_rate({0, 100 * ms, 200 * ms, 400 * ms, 601 * ms, 701 * ms, 1201 * ms});
  EXPECT_DOUBLE_EQ(rate.median_interval_s, 0.2);
  EXPECT_DOUBLE_EQ(rate.rate_hz(), 5.0);
  EXPECT_EQ(rate.gaps, 1U);
  EXPECT_DOUBLE_EQ(rate.longest_gap_s, 0.5);
}

TEST(PingRate, twice_the_median_is_no_gap) {
  EXPECT_EQ(ping_rate({0, 100 * ms, 200 * ms, 300 * ms, 500 * ms}).gaps, 0U);
}

TEST(PingRate, one_ping_has_none) {
  EXPECT_EQ(ping_rate({5}).rate_hz(), 0.0);
  EXPECT_EQ(ping_rate({}).rate_hz(), 0.0);
}

TEST(IsoTime, also_before_1970) {
  EXPECT_EQ(iso_time(1'000'000'000'123'999'999, true), "2001-09-09T01:46:40.123Z");
  EXPECT_EQ(iso_time(-1, false), "1969-12-31T23:59:59.999");
}

TEST(InfoJson, text_of_logs_is_escaped) {
  LogSummary log;
  log.path = "a\"b\\c\nd";
  EXPECT_NE(info_json(log, 0).find(R"("file": "a\"b\\c\u000ad")"), std::string::npos);
}

TEST(Capture, pings_are_counted_by_their_heads) {
  pcapng::Writer writer("test");
  const std::uint32_t bow = writer.add_interface("bow");
  const pcapng::Endpoint head_end{0x7F000002, 52901};
  const pcapng::Endpoint surface{0x7F000001, 52900};
  const auto add = [&](std::uint64_t time_ns, const gemini::Report& report) {
    const auto bytes = gemini::encode(report);
    writer.add_packet(bow, time_ns, pcapng::udp_packet(head_end, surface, bytes));
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
    again.ping_id |= 0x0100;  // sent again: the same ping
    add(1'000'000'000 + ping * 100'000'000 + 1000, again);
    add(1'000'000'000 + ping * 100'000'000 + 2000, gemini::PingTail{});
  }
  const auto whole = writer.take();
  const test::TemporaryLog temporary(".pcapng", std::span(whole).first(whole.size() - 3));
  const LogSummary summary = summarise(LogFile(temporary.path()));
  ASSERT_EQ(summary.heads.size(), 1U);
  EXPECT_EQ(summary.heads[0].id, 600);
  EXPECT_EQ(summary.heads[0].pings(), 3U);
  const RecordedSettings& settings = summary.heads[0].settings.at(0).settings;
  EXPECT_EQ(settings.lines, 100);
  EXPECT_NEAR(settings.range_m(), 200 * 1500.0 / (2 * 90422.0), 1e-9);
  EXPECT_EQ(summary.other_records,
            (std::vector<std::pair<std::string, std::uint64_t>>{{"interfaces", 1}, {"UDP packets", 8}}));
  EXPECT_EQ(summary.problems.size(), 1U) << "the last packet is cut";
}

}  // namespace
}  // namespace sonard::server
