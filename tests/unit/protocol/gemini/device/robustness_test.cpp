// SPDX-License-Identifier: Apache-2.0
// No datagrams from a peer make the head grow, stall or send without end.
#include <algorithm>
#include <random>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

TEST(Robustness, FloodOfRetriesIsBoundedInMemoryAndOutput) {
  Bench bench;
  bench.command(ping_of(1205));
  bench.run_for(100ms);
  const std::size_t before = bench.sent.size();
  for (int i = 0; i < 50'000; ++i) {
    bench.command(retry_of(RetryKind::lines, (i * 7) % 1205, 65535));
    bench.run_for(1us);
  }
  bench.run_for(2s);
  const auto resent = bench.ping_datagrams(before).size();
  EXPECT_LE(resent, 16U * 1205U) << "each line at most 16 times";
  bench.command(ping_of(100));
  bench.run_for(200ms);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 2U) << "and the head goes on";
}

TEST(Robustness, FloodOfRetriesDuringAPingDoesNotDisturbIt) {
  Bench bench;
  bench.command(ping_of(1205));
  for (int i = 0; i < 10'000; ++i) {
    bench.command(retry_of(static_cast<RetryKind>(i % 3), i % 1205, 3));
    bench.run_for(3us);
  }
  bench.run_for(50ms);
  const auto lines = bench.all<PingLine>();
  ASSERT_GE(lines.size(), 1205U);
  for (int i = 0; i < 1205; ++i) {
    ASSERT_EQ(lines[static_cast<std::size_t>(i)].second.line_id, i);
  }
}

TEST(Robustness, FloodOfConfigurationsStartsNoMorePingsThanTheHardwareCan) {
  Bench bench;
  for (int i = 0; i < 1000; ++i) {
    bench.command(ping_of(100));
    bench.run_for(1ms);
  }
  EXPECT_EQ(bench.count(MessageType::ping_head), 31U);  // 1 s / 33.3 ms
}

TEST(Robustness, RandomDatagramsAtRandomTimes) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const auto draw = [&](unsigned below) { return static_cast<unsigned>(random() % below); };
    DeviceConfig config = example_config();
    config.render_lead = draw(2) == 0 ? 0ms : 30ms;
    Bench bench(config);
    bench.render_time = std::chrono::milliseconds(draw(60));
    bench.lateness = [&] { return std::chrono::microseconds(draw(4) == 0 ? draw(20'000) : draw(300)); };
    for (int i = 0; i < 2000; ++i) {
      std::vector<std::uint8_t> bytes(draw(8) == 0 ? draw(30) : 68 + draw(90));
      std::ranges::generate(bytes,
                            [&] { return static_cast<std::uint8_t>(draw(4) == 0 ? draw(256) : draw(4)); });
      if (bytes.size() >= 8 && draw(10) != 0) {
        bytes[0] = static_cast<std::uint8_t>(draw(20) == 0 ? 0xC8 : 0x20 + draw(0x18));
        if (bytes[0] == 0x2B && draw(20) != 0) {
          bytes[0] = 0x30;  // few reboots, many retry requests
        }
        bytes[2] = 0x59;
        bytes[3] = 0x02;
      }
      if (bytes.size() >= 68 && bytes[0] == 0x21) {
        bytes[18] = static_cast<std::uint8_t>(draw(5) == 0 ? draw(256) : 4);
        bytes[22] = static_cast<std::uint8_t>(draw(256));
        bytes[23] = static_cast<std::uint8_t>(draw(6));
      }
      bench.raw(bytes, draw(50) == 0 ? other_client : client_address);
      if (draw(20) == 0) {
        bench.set_out_of_water(draw(2) == 0);
      }
      if (draw(20) == 0) {
        bench.trigger();
      }
      bench.renderer_fails = draw(10) == 0;
      bench.run_for(std::chrono::microseconds(draw(200) == 0 ? draw(8'000'000) : draw(20'000)));
    }
    const DeviceCounters& counters = bench.device.counters();
    EXPECT_GT(counters.pings_started, 10U);
    EXPECT_EQ(bench.all<PingHead>().size(), bench.count(MessageType::ping_head))
        << "all of it can be decoded";
    EXPECT_LE(counters.pings_sent + counters.pings_failed + counters.pings_cancelled, counters.pings_started);
    EXPECT_GE(counters.pings_sent + counters.pings_failed + counters.pings_cancelled + 2,
              counters.pings_started);
  }
}

}  // namespace
}  // namespace sonard::gemini
