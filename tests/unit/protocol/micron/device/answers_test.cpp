// SPDX-License-Identifier: Apache-2.0
// The answer to each command, byte for byte (protocol/micron/README.md 3, 5, 6, 7.2).
#include "bench.hpp"

namespace sonard::micron {
namespace {

using Frames = std::vector<Bytes>;

Frames answers(Bench& bench, const Bytes& command) {
  const std::size_t before = bench.sent.size();
  bench.raw(command);
  Frames frames;
  for (std::size_t i = before; i < bench.sent.size(); ++i) {
    frames.push_back(bench.sent[i].bytes);
  }
  return frames;
}

TEST(Answers, VersionAndFpgaData) {
  Bench bench;
  bench.run_until(5s);
  EXPECT_EQ(answers(bench, fixture("send_version")), Frames{fixture("version_data")});
  EXPECT_EQ(answers(bench, fixture("send_fpga_version")), Frames{fixture("fpga_version_data")});
  EXPECT_EQ(answers(bench, fixture("send_fpga_cal_data")), Frames{fixture("fpga_cal_data")});
}

TEST(Answers, UserBlocksAreFollowedByFpgaDataAndSetSentConfig) {
  Bench bench;
  bench.run_until(5s);
  const Frames frames = answers(bench, fixture("send_bb_user"));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[1], fixture("fpga_cal_data"));
  EXPECT_EQ(frames[2], fixture("fpga_version_data"));
  Bytes blocks = frames[0];
  ASSERT_EQ(blocks.size(), 264U);
  EXPECT_EQ(blocks[19], 15);
  EXPECT_EQ(blocks[146], 0);
  // The blocks equal the example of section 10, except for the fields that only MINIK's field order names.
  for (const std::size_t named : {33U, 35U, 37U, 59U}) {
    EXPECT_NE(blocks[named], 0);
    blocks[named] = 0;
  }
  EXPECT_EQ(blocks, fixture("bb_user_data"));
  bench.run_for(1s);
  EXPECT_EQ(bench.head_infos().back(), 0xCA) << "asked for, and still without parameters";
}

TEST(Answers, UserBlocksTellHalfDuplex) {
  DeviceConfig config;
  config.half_duplex = true;
  Bench bench(config);
  bench.run_until(5s);
  const Frames frames = answers(bench, fixture("send_bb_user"));
  EXPECT_EQ(frames.at(0).at(146), 1);
  EXPECT_EQ(frames.at(0).at(99), 1);
}

TEST(Answers, OlderUserBlocksAreShortAndComeAlone) {
  DeviceConfig config;
  config.half_duplex = true;
  config.user_blocks = UserBlocks::older;
  Bench bench(config);
  bench.run_until(5s);
  const Frames frames = answers(bench, fixture("send_bb_user"));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].size(), 175U);
  EXPECT_NE(frames[0][19], 15);
  EXPECT_EQ(frames[0][99], 1);
}

TEST(Answers, ComeInEveryStateButBooting) {
  Bench bench;
  bench.reboot_at(0);
  bench.run_for(600ms);
  EXPECT_TRUE(answers(bench, fixture("send_version")).empty());
  bench.run_for(900ms);
  EXPECT_EQ(answers(bench, fixture("send_version")).size(), 1U) << "centring";
  bench.make_ready(all_round());
  bench.command(SendData{});
  EXPECT_EQ(answers(bench, fixture("send_version")).size(), 1U) << "scanning";
}

TEST(Answers, ParametersAreAnsweredByAnAlive) {
  Bench bench;
  bench.run_until(10s);
  for (const char* name :
       {"head_command_ros", "head_command_rock", "head_command_uxv", "head_command_gain_block"}) {
    const Frames frames = answers(bench, fixture(name));
    ASSERT_EQ(frames.size(), 1U) << name;
    EXPECT_EQ(frames[0][10], static_cast<int>(MessageType::alive)) << name;
  }
}

TEST(Answers, CommandsWithoutAnswerAreTakenInSilence) {
  Bench bench;
  bench.run_until(10s);
  bench.command(all_round());
  for (const char* name : {"gain", "reverse", "stop_alives", "head_command_ros"}) {
    EXPECT_TRUE(answers(bench, fixture(name)).empty()) << name;
  }
  EXPECT_EQ(bench.device.counters().commands, 5U);
}

TEST(Answers, UnknownTypesAreIgnored) {
  Bench bench;
  bench.run_until(10s);
  for (const int type : {0, 13, 14, 15, 20, 21, 22, 26, 27, 40, 61, 64, 67, 70, 72, 99, 255}) {
    EXPECT_TRUE(answers(bench, frame_to_head(2, static_cast<std::uint8_t>(type), Bytes{1, 2, 3})).empty());
  }
  EXPECT_EQ(bench.device.counters().unknown_type, 17U);
  Bytes odd_form = fixture("head_command_ros");
  odd_form[13] = 0x77;
  bench.raw(odd_form);
  EXPECT_EQ(bench.device.counters().bad_frames, 1U);
  EXPECT_EQ(bench.device.state(bench.now), HeadState::without_parameters);
}

TEST(Answers, OnlyTheOwnNodeAndBroadcastsAreHeard) {
  Bench bench;
  bench.run_until(10s);
  Bytes request = fixture("send_version");
  for (const int node : {0, 1, 3, 20}) {
    request[8] = static_cast<std::uint8_t>(node);
    EXPECT_TRUE(answers(bench, request).empty());
  }
  EXPECT_EQ(bench.device.counters().wrong_node, 4U);
  request[8] = 255;
  EXPECT_EQ(answers(bench, request), Frames{fixture("version_data")});
}

TEST(Answers, NodeCanBeSet) {
  DeviceConfig config;
  config.node = 20;
  Bench bench(config);
  bench.run_until(10s);
  const Frames frames = answers(bench, encode(SendVersion{}, 20));
  Bytes expected = fixture("version_data");
  expected[7] = expected[12] = expected[23] = 20;
  EXPECT_EQ(frames, Frames{expected});
}

TEST(Answers, HeaderBytesThatDriversGetWrongDoNotMatter) {
  Bench bench;
  bench.run_until(10s);
  Bytes request = fixture("send_version");
  request[7] = 0x33;
  request[9] = 56;
  request[11] = 0;
  request[12] = 9;
  EXPECT_EQ(answers(bench, request).size(), 1U);
}

TEST(Answers, HeaderBytesAreWhatTheStrictestDriverWants) {
  Bench bench;
  bench.make_ready(all_round());
  bench.raw(fixture("send_version"));
  bench.raw(fixture("send_bb_user"));
  bench.scan(3);
  bench.run_for(1s);
  ASSERT_GE(bench.sent.size(), 8U);
  for (const auto& [at, frame] : bench.sent) {
    const FrameHeader header = frame_header(frame);
    EXPECT_EQ(header.tx_node, 2);
    EXPECT_EQ(header.rx_node, 255);
    EXPECT_EQ(header.node, 2);
    EXPECT_EQ(header.sequence, 0x80);
    EXPECT_LE(header.type, 72);
    EXPECT_EQ(header.count, header.type == 2 ? 0 : static_cast<std::uint8_t>(frame.size() - 11));
    EXPECT_EQ(frame[5] | frame[6] << 8, static_cast<int>(frame.size()) - 6);
  }
}

}  // namespace
}  // namespace sonard::micron
