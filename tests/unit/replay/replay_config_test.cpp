// SPDX-License-Identifier: Apache-2.0
// Which recorded head is served as which, what a 720i can send, and what is told about requests that differ.
#include "server/replay/replay_config.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "protocol/gemini/bearings.hpp"
#include "protocol/micron/line_job.hpp"
#include "server/replay/differences.hpp"

namespace sonard::server {
namespace {

RecordedSettings settings(double line_step_m = 1500.0 / (2 * 90422.0)) {
  RecordedSettings settings;
  settings.lines = 482;
  settings.beams = 256;
  settings.line_step_m = line_step_m;
  settings.sound_speed_mps = 1500.0;
  settings.gain_percent = 50.0;
  return settings;
}

RecordedHead recorded(std::uint16_t device_id) {
  RecordedHead head;
  head.device_id = device_id;
  head.images.push_back({0, settings(), 0});
  for (const double bearing_rad : gemini::bearings_rad()) {
    head.bearings_rad.push_back(-bearing_rad);
  }
  return head;
}

GeminiHeadConfig configured(const std::string& name, std::uint16_t id) {
  GeminiHeadConfig head;
  head.name = name;
  head.device.sonar_id = id;
  return head;
}

struct ReplayConfigTest : testing::Test {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("sonard-replay-" + std::to_string(getpid()) + ".dat");
  DaemonConfig config;

  ReplayConfigTest() {
    std::ofstream(path) << "\xDE\xDE";
    spdlog::set_level(spdlog::level::off);
  }
  ~ReplayConfigTest() override {
    std::filesystem::remove(path);
    spdlog::set_level(spdlog::level::info);
  }
};

TEST_F(ReplayConfigTest, heads_find_their_recording_by_id) {
  config.heads = {configured("a", 600), configured("b", 513), MicronHeadConfig{}};
  const std::vector<RecordedHead> heads{recorded(513), recorded(600)};
  const ReplayConfig replay = replay_config(config, heads, {}, LogFile(path));
  ASSERT_EQ(replay.played.size(), 2U);
  EXPECT_EQ(replay.daemon.heads.size(), 2U);
  EXPECT_EQ(std::get<const RecordedHead*>(replay.played[0].recorded), &heads[1]);
  EXPECT_EQ(std::get<const RecordedHead*>(replay.played[1].recorded), &heads[0]);
  for (const AnyHeadConfig& head : replay.daemon.heads) {
    EXPECT_TRUE(std::get<GeminiHeadConfig>(head).device.plays_back);
  }
}

TEST_F(ReplayConfigTest, one_head_plays_one_recording_whatever_the_ids) {
  config.heads = {configured("a", 600)};
  const std::vector<RecordedHead> heads{recorded(513)};
  const ReplayConfig replay = replay_config(config, heads, {}, LogFile(path));
  EXPECT_EQ(std::get<GeminiHeadConfig>(replay.daemon.heads.at(0)).device.sonar_id, 600);
}

TEST_F(ReplayConfigTest, no_head_at_all_is_an_error) {
  config.heads = {configured("a", 600), configured("b", 601)};
  const std::vector<RecordedHead> heads{recorded(513)};
  EXPECT_THROW(replay_config(config, heads, {}, LogFile(path)), LogError);
}

TEST_F(ReplayConfigTest, images_of_other_heads_are_an_error_that_says_so) {
  std::vector<RecordedHead> heads{recorded(513)};
  heads[0].images[0].settings.beams = 512;
  try {
    replay_config(loopback_config(heads, {}), heads, {}, LogFile(path));
    FAIL() << "512 beams are taken";
  } catch (const LogError& error) {
    EXPECT_EQ(std::string(error.what()), path.string() +
                                             ": sonar 513 has an image of 482 lines of 512 beams, which a "
                                             "Gemini 720i cannot send (expected 256 beams)");
  }
}

TEST_F(ReplayConfigTest, times_that_make_no_sense_are_an_error) {
  std::vector<RecordedHead> heads{recorded(513)};
  heads[0].images.push_back({std::int64_t{91} * 86'400 * 1'000'000'000, settings(), 1});
  EXPECT_THROW(replay_config(loopback_config(heads, {}), heads, {}, LogFile(path)), LogError);
}

TEST(WireForm, compression_follows_from_the_length_of_a_line) {
  for (int log2 = 0; log2 <= 4; ++log2) {
    const auto form = wire_form(settings(1500.0 / (2 * 90422.0) * (1 << log2)));
    ASSERT_TRUE(form);
    EXPECT_EQ(form->ping.compression_log2, log2);
    EXPECT_EQ(form->ping.lines, 482);
    EXPECT_TRUE(form->exact);
  }
  // As a .glf rounds it: 90422 / 16 = 5651.4, written as 5651.
  EXPECT_TRUE(wire_form(settings(1500.0 / (2 * 5651.0)))->exact);
}

TEST(WireForm, lines_that_a_720i_does_not_have_are_no_exact_ones) {
  const auto form = wire_form(settings(1500.0 / (2 * 18750.0)));
  ASSERT_TRUE(form);
  EXPECT_FALSE(form->exact);
}

std::vector<std::string> texts(const std::vector<Difference>& found) {
  std::vector<std::string> texts;
  std::ranges::transform(found, std::back_inserter(texts), &Difference::text);
  return texts;
}

struct Asked : testing::Test {
  gemini::PingJob asked;
  RecordedSettings sent = settings();
  Asked() {
    asked.native_lines = 482;
    asked.line_step_m = 1500.0 / (2 * 90422.0);
    asked.sound_speed_mps = asked.assumed_sound_speed_mps = 1500.0;
    asked.gain_percent = 50.2;
  }
  std::vector<std::string> all() const { return texts(differences(asked, wire_form(sent)->ping, sent)); }
};

TEST_F(Asked, the_same_is_no_difference) {
  EXPECT_TRUE(all().empty());
}

TEST_F(Asked, each_kind_is_told) {
  asked.native_lines = 2411;
  asked.compression_log2 = 2;
  asked.gain_percent = 80.0;
  asked.assumed_sound_speed_mps = 1480.0;
  asked.sixteen_bit = true;
  asked.rle_threshold = 3;
  asked.transmit = false;
  EXPECT_EQ(all(), (std::vector<std::string>{
                       "range 20.00 m asked for, 4.00 m sent", "compression x4 asked for, x1 sent",
                       "gain 80 % asked for, 50 % sent", "sound speed 1480.0 m/s asked for, 1500.0 m/s sent",
                       "16 bits asked for, 8 bits sent", "run lengths asked for, all samples sent",
                       "listening only asked for, a ping with its echoes sent"}));
}

// ---- Microns

RecordedScan scanned(const std::string& name, std::uint16_t node) {
  RecordedScanLine line;
  line.settings.lines = 20;
  line.settings.beams = 1;
  line.wire_line.emplace();
  return {name, node, {line}};
}

MicronHeadConfig micron(const std::string& name, std::uint8_t node) {
  MicronHeadConfig head;
  head.name = name;
  head.device.node = node;
  return head;
}

TEST_F(ReplayConfigTest, microns_find_their_recording_by_name_and_else_by_node) {
  config.heads = {micron("a", 2), micron("b", 2), micron("c", 9), micron("d", 3)};
  const std::vector<RecordedScan> scans{scanned("b", 2), scanned("a", 2), scanned("elsewhere", 9)};
  const ReplayConfig replay = replay_config(config, {}, scans, LogFile(path));
  ASSERT_EQ(replay.played.size(), 3U);
  EXPECT_EQ(std::get<const RecordedScan*>(replay.played[0].recorded), &scans[1]);
  EXPECT_EQ(std::get<const RecordedScan*>(replay.played[1].recorded), &scans[0]);
  EXPECT_EQ(std::get<const RecordedScan*>(replay.played[2].recorded), &scans[2]);
  EXPECT_TRUE(std::get<MicronHeadConfig>(replay.daemon.heads[2]).device.plays_back);
}

TEST_F(ReplayConfigTest, one_of_each_kind_play_one_of_each_kind) {
  config.heads = {configured("a", 600), micron("mast", 7)};
  const std::vector<RecordedHead> heads{recorded(513)};
  const std::vector<RecordedScan> scans{scanned("stern", 2)};
  const ReplayConfig replay = replay_config(config, heads, scans, LogFile(path));
  ASSERT_EQ(replay.played.size(), 2U);
  EXPECT_EQ(std::get<const RecordedHead*>(replay.played[0].recorded), &heads[0]);
  EXPECT_EQ(std::get<const RecordedScan*>(replay.played[1].recorded), &scans[0]);
}

TEST_F(ReplayConfigTest, without_a_configuration_microns_are_behind_the_geminis_on_loopback) {
  const std::vector<RecordedHead> heads{recorded(513)};
  const std::vector<RecordedScan> scans{scanned("", 7)};
  const DaemonConfig loopback = loopback_config(heads, scans);
  ASSERT_EQ(loopback.heads.size(), 2U);
  const auto& head = std::get<MicronHeadConfig>(loopback.heads[1]);
  EXPECT_EQ(head.name, "micron-7");
  EXPECT_EQ(head.device.node, 7);
  ASSERT_EQ(head.serial.tcp.size(), 1U);
  EXPECT_EQ(head.serial.tcp[0].bind.address, 0x7F000003U);
  EXPECT_EQ(head.serial.tcp[0].bind.port, 4001);
}

TEST_F(ReplayConfigTest, lines_that_do_not_say_how_they_travelled_are_an_error) {
  config.heads = {micron("a", 2)};
  std::vector<RecordedScan> scans{scanned("a", 2)};
  scans[0].lines[0].wire_line.reset();
  EXPECT_THROW(replay_config(config, {}, scans, LogFile(path)), LogError);
}

TEST(LineDifferences, the_same_is_no_difference_and_each_kind_is_told) {
  micron::RecordedLine recorded;
  recorded.bins = 400;
  recorded.sound_speed_mps = 1500.0;
  recorded.line.control = 0x2307;
  recorded.line.ad_interval = 53;
  recorded.line.gain = 105;
  recorded.line.step = 32;
  const micron::MicronJob sent = micron::make_line_job(recorded);
  micron::HeadCommand asked;
  EXPECT_TRUE(differences(asked, sent, recorded.line).empty());
  asked.control = 0x2324;  // 4 bits, a sector, listening only
  asked.ad_interval = 106;
  asked.bins = 800;
  asked.gain[0] = 210;
  asked.step = 8;
  EXPECT_EQ(texts(differences(asked, sent, recorded.line)),
            (std::vector<std::string>{"range 40.70 m asked for, 10.18 m sent", "800 bins asked for, 400 sent",
                                      "gain 80.0 dB asked for, 40.0 dB sent", "4 bits asked for, 8 bits sent",
                                      "sector -45.0 to 44.9 degrees asked for, all round sent",
                                      "step 8 asked for, 32 sent (1/16 gradian)",
                                      "listening only asked for, a line with its echoes sent"}));
}

}  // namespace
}  // namespace sonard::server
