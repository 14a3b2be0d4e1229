// SPDX-License-Identifier: Apache-2.0
// Content of a ping's datagrams, and of its job (protocol/gemini/README.md 5, 6, 10).
#include <algorithm>
#include <string_view>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

// Worked example: single ping, 8 bit, 483 lines, gain 0x83E8, spreading 67, 1499.2 m/s taken from the config.
constexpr std::string_view example_ping =
    "21 01 59 02 00 00 00 00 00 00 00 00 00 00 00 00"
    "00 00 04 02 00 00 e3 01 40 0d 03 00 04 00 00 00"
    "e8 83 00 00 00 1e 00 00 43 00 00 00 07 00 01 00"
    "90 3a 01 00 00 00 00 00 00 00 00 00 01 1d 00 00"
    "01 12 1e 11";

PingImage image_of_beam_numbers(const PingJob& job) {
  PingImage image;
  image.number = job.number;
  for (int i = 0; i < job.bins() * beam_count; ++i) {
    image.u8.push_back(static_cast<std::uint8_t>(i % beam_count));
  }
  return image;
}

/// Sends one ping of `config` and returns its datagrams.
std::vector<Bench::Sent> ping(Bench& bench, const PingConfig& config) {
  const std::size_t before = bench.sent.size();
  bench.command(config);
  bench.run_for(1s);
  return bench.ping_datagrams(before);
}

TEST(PingContent, IsTheWorkedExampleByteForByte) {
  Bench bench;
  bench.render = image_of_beam_numbers;
  for (int earlier = 0; earlier < 5; ++earlier) {
    ping(bench, ping_of(32));
  }
  bench.run_until(std::chrono::microseconds{0x12350000});
  const std::size_t before = bench.sent.size();
  bench.raw(from_hex(example_ping));
  bench.run_for(100ms);
  const auto sent = bench.ping_datagrams(before);
  ASSERT_EQ(sent.size(), 485U);
  EXPECT_EQ(copy(sent[0].bytes), from_hex("41 01 59 02 00 00 00 00 05 00 04 02 00 00 35 12"
                                          "00 00 00 00 00 00 e3 01 00 00 00 00 00 01 60 00"
                                          "00 02 90 3a 00 00 01 00 00 00 90 ba 00 00 00 00"));
  auto line_0 = from_hex("42 01 59 02 00 00 00 00 00 05 00 00 00 1e 04 20");
  for (int beam = 0; beam < 256; ++beam) {
    line_0.push_back(static_cast<std::uint8_t>(beam));
  }
  EXPECT_EQ(copy(sent[1].bytes), line_0);
  EXPECT_EQ(copy(std::span(sent[483].bytes).first(16)),
            from_hex("42 01 59 02 00 00 00 00 00 05 e2 01 00 1e 44 20"));
  EXPECT_EQ(copy(sent[484].bytes), from_hex("43 01 59 02 00 00 00 00 05 00 00 00"));

  bench.raw(from_hex("30 01 59 02 00 00 00 00 01 00 0a 00 01 00 00 00"));
  ASSERT_EQ(bench.sent.back().bytes.size(), 272U);
  EXPECT_EQ(copy(std::span(bench.sent.back().bytes).first(16)),
            from_hex("42 01 59 02 00 00 00 00 00 05 0a 80 00 1e 04 20"));
  EXPECT_TRUE(
      std::ranges::equal(std::span(bench.sent.back().bytes).subspan(16), std::span(line_0).subspan(16)));
  bench.raw(from_hex("30 01 59 02 00 00 00 00 02 00 00 00 01 00 00 00"));
  EXPECT_EQ(copy(bench.sent.back().bytes), from_hex("43 01 59 02 00 00 00 00 05 80 00 00"));
}

TEST(PingContent, WorkedExampleMakesThisJob) {
  Bench bench;
  bench.run_until(1s);
  bench.raw(from_hex(example_ping));
  ASSERT_EQ(bench.jobs.size(), 1U);
  const PingJob& job = bench.jobs[0];
  EXPECT_EQ(job.number, 0U);
  EXPECT_EQ(job.transmit_time, 1s);
  EXPECT_EQ(job.native_bins, 483);
  EXPECT_EQ(job.bins(), 483);
  EXPECT_EQ(job.compression_log2, 0);
  EXPECT_FALSE(job.sixteen_bit);
  EXPECT_TRUE(job.transmit);
  EXPECT_NEAR(job.sound_speed_mps, 1499.2, 1e-9);
  EXPECT_NEAR(job.native_bin_m, 0.0082900179, 1e-9);  // 1499.2 / 180844
  EXPECT_NEAR(job.gain_db, -5.5, 1e-9);               // base gain 11 dB instead of 16.5
}

TEST(PingContent, LinesCountUpAndOnlyTheLastSaysSo) {
  Bench bench;
  bench.command(ping_of(700));
  bench.run_for(1s);
  const auto lines = bench.all<PingLine>();
  ASSERT_EQ(lines.size(), 700U);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(lines[i].second.line_id, i);
    EXPECT_EQ(lines[i].second.line_info, i == 699 ? 0x2044 : 0x2004);
    ASSERT_EQ(lines[i].second.data.size(), 256U);
    EXPECT_EQ(lines[i].second.data[17], test_sample(0, static_cast<int>(i), 17));
  }
}

TEST(PingContent, PingIdWrapsAt256WithTheUpperByteZero) {
  Bench bench;
  bench.command(ping_of(32, RunMode::continuous, 40ms));
  bench.run_connected(12s + 10ms);
  const auto heads = bench.all<PingHead>();
  ASSERT_GT(heads.size(), 260U);
  for (std::size_t i = 0; i < heads.size(); ++i) {
    ASSERT_EQ(heads[i].second.ping_id, i % 256);
  }
  for (const auto& [at, line] : bench.all<PingLine>()) {
    ASSERT_LT(line.ping_id, 256);
  }
  EXPECT_EQ(bench.all<PingLine>().back().second.ping_id, heads.back().second.ping_id);
  EXPECT_EQ(bench.all<PingTail>().back().second.ping_id, heads.back().second.ping_id);
}

TEST(PingContent, APingThatIsCancelledBeforeItsHeadIsNotRecorded) {
  Bench bench;
  bench.renderer_answers = false;
  bench.command(ping_of(40));
  bench.run_connected(1s);
  EXPECT_EQ(bench.jobs.size(), 1U);
  EXPECT_TRUE(bench.records.empty());
}

struct Compression {
  int range_compression;
  int applied;
  std::size_t lines;
};

TEST(PingContent, RangeCompressionDividesTheLines) {
  // floor(2411 / 2^k); 5, 6 and 7 count as 0; bit 8 (peak) is ignored by a 720i.
  for (const Compression& c : {Compression{0, 0, 2411},
                               {1, 1, 1205},
                               {2, 2, 602},
                               {3, 3, 301},
                               {4, 4, 150},
                               {5, 0, 2411},
                               {7, 0, 2411},
                               {0x101, 1, 1205}}) {
    Bench bench;
    PingConfig config = ping_of(2411);
    config.range_compression = static_cast<std::uint16_t>(c.range_compression);
    const auto sent = ping(bench, config);
    ASSERT_EQ(sent.size(), c.lines + 2) << c.range_compression;
    const PingHead head = bench.all<PingHead>()[0].second;
    EXPECT_EQ(head.end_range, 2411) << "the head reports native lines";
    EXPECT_EQ(head.range_compression, c.applied);
    EXPECT_EQ(bench.jobs[0].native_bins, 2411);
    EXPECT_EQ(bench.jobs[0].compression_log2, c.applied);
    EXPECT_TRUE(bench.all<PingLine>().back().second.last());
  }
}

TEST(PingContent, RunLengthCodingDropsWhatIsBelowTheThreshold) {
  Bench bench;
  bench.render = [](const PingJob& job) {
    PingImage image;
    image.number = job.number;
    for (int line = 0; line < job.bins(); ++line) {
      std::vector<std::uint8_t> beams(256, 49);  // all below 50
      if (line == 1) {
        beams[0] = 50;
        beams[1] = 200;
        beams[3] = 255;
      }
      image.u8.insert(image.u8.end(), beams.begin(), beams.end());
    }
    return image;
  };
  PingConfig config = ping_of(32);
  config.rle_threshold = 50;
  const auto sent = ping(bench, config);
  EXPECT_EQ(bench.all<PingHead>()[0].second.rle_threshold, 50);
  // 256 zeros are a run of 255 and a single zero: three bytes and one byte of padding, one word.
  EXPECT_EQ(copy(std::span(sent[1].bytes).subspan(14)), from_hex("84 00 00 ff 01 00"));
  // 50, 200, one zero, 255, 252 zeros: six bytes and two bytes of padding.
  EXPECT_EQ(copy(std::span(sent[2].bytes).subspan(14)), from_hex("04 01 32 c8 01 ff 00 fc 00 00"));
}

TEST(PingContent, SmallRunLengthThresholdsActAsThree) {
  for (const auto& [asked, applied] : {std::pair{0, 0}, {1, 3}, {2, 3}, {3, 3}, {255, 255}}) {
    Bench bench;
    PingConfig config = ping_of(32);
    config.rle_threshold = static_cast<std::uint16_t>(asked);
    ping(bench, config);
    EXPECT_EQ(bench.all<PingHead>()[0].second.rle_threshold, applied);
  }
}

TEST(PingContent, SixteenBitSamplesTravelMostSignificantByteFirstAndUncoded) {
  Bench bench;
  bench.render = [](const PingJob& job) {
    PingImage image;
    image.number = job.number;
    image.u16.assign(static_cast<std::size_t>(job.bins()) * beam_count, 0x0102);
    image.u16[1] = 0xFEDC;
    return image;
  };
  PingConfig config = ping_of(64);
  config.ext_mode = 0x0200;
  config.rle_threshold = 50;
  const auto sent = ping(bench, config);
  ASSERT_EQ(sent.size(), 66U);
  EXPECT_TRUE(bench.jobs[0].sixteen_bit);
  EXPECT_EQ(bench.all<PingHead>()[0].second.ext_mode, 0x0200);
  EXPECT_EQ(bench.all<PingHead>()[0].second.rle_threshold, 0) << "no run-length coding with 16 bit";
  EXPECT_EQ(sent[1].bytes.size(), 16U + 512U);
  EXPECT_EQ(copy(std::span(sent[1].bytes).subspan(10, 12)), from_hex("00 00 00 ff 00 40 01 02 fe dc 01 02"));
  EXPECT_EQ(copy(std::span(sent[64].bytes).subspan(14, 2)), from_hex("40 40"));
}

TEST(PingContent, TooFewOrTooManyLinesAreReportedAsSent) {
  struct Case {
    int asked;
    std::uint16_t ext_mode;
    int sent;
  };
  for (const Case& c : {Case{0, 0x204, 32},
                        {1, 0x204, 32},
                        {31, 0x204, 32},
                        {32, 0x204, 32},
                        {20000, 0x204, 20000},
                        {65535, 0x204, 20000},
                        {65535, 0x200, 10000}}) {
    Bench bench;
    bench.renderer_answers = false;
    PingConfig config = ping_of(c.asked);
    config.ext_mode = c.ext_mode;
    config.range_compression = 4;
    bench.command(config);
    ASSERT_EQ(bench.jobs.size(), 1U);
    EXPECT_EQ(bench.jobs[0].native_bins, c.sent);
    bench.answer(test_image(bench.jobs[0]));
    bench.run_for(2s);
    EXPECT_EQ(bench.all<PingHead>()[0].second.end_range, c.sent);
    EXPECT_EQ(bench.count(MessageType::ping_line), static_cast<std::size_t>(c.sent / 16));
  }
}

TEST(PingContent, StartRangeAndReservedFieldsAreIgnored) {
  Bench bench;
  PingConfig config = ping_of(100);
  config.start_range = 50;
  config.sample_channel = 0x60;
  config.tx_angle = 7;
  const auto sent = ping(bench, config);
  EXPECT_EQ(sent.size(), 102U);
  EXPECT_EQ(bench.all<PingHead>()[0].second.start_range, 0);
  EXPECT_EQ(bench.all<PingHead>()[0].second.sample_channel, 0x60);
}

TEST(PingContent, ListeningWithoutTransmitting) {
  Bench bench;
  PingConfig config = ping_of(100);
  config.tx_length = 0;
  EXPECT_EQ(ping(bench, config).size(), 102U);
  EXPECT_FALSE(bench.jobs[0].transmit);
}

struct Speed {
  double water_mps;
  bool snap;
  int configured;  // units of 0.1 m/s
  bool use_configured;
  double job_mps;
  double assumed_mps;
  int velocimeter;  // units of 0.1 m/s, in the ping head
  int used;
};

TEST(PingContent, SpeedOfSoundComesFromTheConfigurationOrTheWater) {
  for (const Speed& s : {
           Speed{0.0, false, 15000, true, 1500.0, 1500.0, 15000, 0x8000 | 15000},  // water as configured
           Speed{0.0, false, 14800, false, 1480.0, 1480.0, 14800, 14800},
           Speed{1480.0, false, 15000, true, 1480.0, 1500.0, 14800, 0x8000 | 15000},  // deliberate mismatch
           Speed{1480.0, false, 15000, false, 1480.0, 1480.0, 14800, 14800},
           Speed{0.0, true, 15000, true, 1500.0, 1500.0, 14992,
                 0x8000 | 14992},  // the device's grid: 1499.2 m/s
           Speed{0.0, false, 0, true, 1400.0, 1400.0, 14000, 0x8000 | 14000},
           Speed{0.0, false, 65535, true, 1588.8, 1588.8, 15888, 0x8000 | 15888},
       }) {
    DeviceConfig device = example_config();
    device.water_sound_speed_mps = s.water_mps;
    device.snap_sound_speed = s.snap;
    Bench bench(device);
    PingConfig config = ping_of(100);
    config.sound_speed = static_cast<std::uint16_t>(s.configured);
    config.velocimeter_mode = s.use_configured ? 1 : 0;
    ping(bench, config);
    EXPECT_NEAR(bench.jobs[0].sound_speed_mps, s.job_mps, 1e-9);
    EXPECT_NEAR(bench.jobs[0].assumed_sound_speed_mps, s.assumed_mps, 1e-9);
    EXPECT_NEAR(bench.jobs[0].native_bin_m, s.job_mps / 180844.0, 1e-12);
    EXPECT_EQ(bench.all<PingHead>()[0].second.velocimeter_speed, s.velocimeter);
    EXPECT_EQ(bench.all<PingHead>()[0].second.sound_speed_used, s.used);
  }
}

TEST(PingContent, TransmitTimeIsThatOfTheJobOnTheHeadClock) {
  Bench bench;
  bench.render_time = 30ms;
  bench.run_until(2500ms);
  ping(bench, ping_of(100));
  EXPECT_EQ(bench.jobs[0].transmit_time, 2500ms);
  EXPECT_EQ(bench.all<PingHead>()[0].second.transmit_time_us, 2'500'000U) << "not the time at which it left";
}

TEST(PingContent, EveryDatagramFitsIntoOneFrame) {
  for (const std::uint16_t ext_mode : {0x0204, 0x0200}) {
    Bench bench;
    PingConfig config = ping_of(64);
    config.ext_mode = ext_mode;
    ping(bench, config);
    for (const auto& datagram : bench.sent) {
      EXPECT_LE(datagram.bytes.size(), max_datagram_size);
    }
  }
}

}  // namespace
}  // namespace sonard::gemini
