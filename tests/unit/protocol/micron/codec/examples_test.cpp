// SPDX-License-Identifier: Apache-2.0
// The byte examples in both directions: bytes to values, and values to bytes
// (docs/protocols/micron.md 10; tests/data/micron/notes.md).
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "protocol/micron/codec.hpp"
#include "tests/unit/protocol/micron/codec/fixture.hpp"

namespace sonard::micron::testing {
namespace {

struct CommandExample {
  std::string fixture;
  Command value;
};

struct ReportExample {
  std::string fixture;
  Report value;
};

void PrintTo(const CommandExample& example, std::ostream* out) {
  *out << example.fixture;
}
void PrintTo(const ReportExample& example, std::ostream* out) {
  *out << example.fixture;
}

GainCommand gain_example() {
  GainCommand command;
  command.values = {.ad_span = {63, 63}, .ad_low = {15, 15}, .gain = {84, 84}, .slope = {100, 100}};
  return command;
}

HeadCommand ros_example() {
  HeadCommand command;
  command.control = 0x2307;
  command.head_type = 0x11;
  command.range_scale = 100;
  command.left_limit = 2400;
  command.right_limit = 3999;
  command.ad_span = 255;
  command.ad_low = 0;
  command.gain = {105, 105};
  command.motor_time = 25;
  command.step = 32;
  command.ad_interval = 53;
  command.bins = 400;
  command.max_ad_buffer = 500;
  command.lockout_us = 100;
  command.minor_axis = 1600;
  command.major_axis = 1;
  return command;
}

HeadCommand rock_example() {
  HeadCommand command = ros_example();
  command.control = 0x2383;
  command.head_type = 2;
  command.left_limit = 0;
  command.right_limit = 0;
  command.range_scale = 100;
  command.ad_span = 81;
  command.ad_low = 8;
  command.gain = {84, 84};
  command.step = 88;
  command.ad_interval = 104;
  command.bins = 200;
  command.max_ad_buffer = 1000;
  command.lockout_us = 13333;
  command.gain_block.emplace();
  return command;
}

HeadCommand uxv_example() {
  HeadCommand command = ros_example();
  command.control = 0x2301;
  command.tx_word = {0x05666666, 0x05666666};
  command.rx_word = {0x090A3D70, 0x090A3D70};
  command.tx_pulse_us = 37;
  command.range_scale = 50;
  command.right_limit = 4000;
  command.ad_span = 79;
  command.ad_low = 9;
  command.slope = {100, 100};
  command.ad_interval = 52;
  command.bins = 200;
  command.max_ad_buffer = 1000;
  return command;
}

HeadCommand gain_block_example() {
  HeadCommand command = uxv_example();
  command.control = 0x2305;
  command.tx_word = {0x05999999, 0x00147AE1};
  command.rx_word = {0x05999999, 0x03B851EB};
  command.tx_pulse_us = 50;
  command.range_scale = 80;
  command.ad_span = 89;
  command.ad_low = 63;
  command.gain = {105, 100};
  command.slope = {100, 0};
  command.step = 16;
  command.ad_interval = 42;
  command.bins = 400;
  command.lockout_us = 500;
  command.gain_block = GainBlock{.ad_span = {89, 50},
                                 .ad_low = {63, 0},
                                 .gain = {105, 100},
                                 .set_point = {0, 0},
                                 .slope = {100, 0},
                                 .slope_delay = {0, 0}};
  return command;
}

std::vector<CommandExample> command_examples() {
  return {
      {"send_version", SendVersion{}},
      {"send_bb_user", SendBBUser{}},
      {"reboot", Reboot{}},
      {"stop_alives", StopAlives{}},
      {"send_fpga_version", SendFpgaVersion{}},
      {"send_fpga_cal_data", SendFpgaCalData{}},
      {"send_data", SendData{0}},
      {"send_data_with_time", SendData{61'891'786}},
      {"reverse", ReverseCommand{}},
      {"gain", gain_example()},
      {"head_command_ros", ros_example()},
      {"head_command_rock", rock_example()},
      {"head_command_uxv", uxv_example()},
      {"head_command_gain_block", gain_block_example()},
  };
}

BBUserData user_blocks_example() {
  BBUserData blocks;
  blocks.lan_timeout = 0;
  blocks.main_port = {};
  blocks.has_motor = 0;
  return blocks;
}

// Lines are views of their bins, so the bins must outlive them.
const Bytes eight_bins{0xB0, 0x40, 0x0A, 0x12, 0x14, 0xE6, 0x40, 0x0A};
const Bytes eight_nibbles{0xF8, 0x10, 0x0A, 0x40};
const Bytes counted_bins = [] {
  Bytes bins(45);
  std::iota(bins.begin(), bins.end(), std::uint8_t{1});
  return bins;
}();

HeadData line_example() {
  HeadData line;
  line.status = 0x10;
  line.control = 0x2307;
  line.range_scale = 100;
  line.gain = 105;
  line.ad_span = 255;
  line.ad_interval = 53;
  line.left_limit = 2400;
  line.right_limit = 3999;
  line.step = 32;
  line.bearing = 3232;
  line.data = eight_bins;
  return line;
}

HeadData four_bit_line_example() {
  HeadData line = line_example();
  line.status = 0;
  line.sweep = SweepCode::right_limit;
  line.control = 0x2304;
  line.ad_span = 77;
  line.ad_low = 40;
  line.right_limit = 4000;
  line.step = 16;
  line.bearing = 4000;
  line.data = eight_nibbles;
  return line;
}

HeadData imaging_line_example() {
  HeadData line;
  line.device_type = 2;
  line.status = 0x10;
  line.sweep = SweepCode::centre;
  line.control = 0xA385;
  line.range_scale = 60;
  line.tx_word = 0x05666666;
  line.gain = 107;
  line.slope = 125;
  line.ad_span = 50;
  line.ad_low = 44;
  line.ad_interval = 107;
  line.left_limit = 1600;
  line.right_limit = 4800;
  line.step = 16;
  line.bearing = 2688;
  line.data = counted_bins;
  return line;
}

std::vector<ReportExample> report_examples() {
  return {
      {"version_data", VersionData{0x31, 0x11, 0x8C0D, 43'139, 0x883C, 2}},
      {"alive_5d", Alive{0x80, 4266, 3200, 0x5D}},
      {"alive_4d", Alive{0x80, 5266, 3200, 0x4D}},
      {"alive_4a", Alive{0x80, 6266, 3200, 0x4A}},
      {"alive_ca", Alive{0x80, 7266, 3200, 0xCA}},
      {"alive_8a", Alive{0x00, 8266, 3200, 0x8A}},
      {"alive_aa", Alive{0x00, 9266, 2400, 0xAA}},
      {"bb_user_data", user_blocks_example()},
      {"fpga_version_data", FpgaVersionData{}},
      {"fpga_cal_data", FpgaCalData{}},
      {"aux_data", AuxData{{'0', '1', '2', '3', '4', 'm', 'm', '\r', 0}}},
      {"head_data", line_example()},
      {"head_data_4_bit", four_bit_line_example()},
      {"head_data_imaging", imaging_line_example()},
  };
}

template <class Example>
std::string example_name(const ::testing::TestParamInfo<Example>& info) {
  return info.param.fixture;
}

class CommandExampleTest : public ::testing::TestWithParam<CommandExample> {};
class ReportExampleTest : public ::testing::TestWithParam<ReportExample> {};

TEST_P(CommandExampleTest, BytesMeanTheValue) {
  const auto decoded = decode_command(load_fixture(GetParam().fixture));
  ASSERT_TRUE(decoded) << to_string(decoded.error());
  EXPECT_TRUE(*decoded == GetParam().value);
}

TEST_P(CommandExampleTest, ValueBecomesTheBytes) {
  EXPECT_EQ(encode(GetParam().value), load_fixture(GetParam().fixture));
}

TEST_P(ReportExampleTest, BytesMeanTheValue) {
  const Bytes bytes = load_fixture(GetParam().fixture);
  const auto decoded = decode_report(bytes);
  ASSERT_TRUE(decoded) << to_string(decoded.error());
  EXPECT_TRUE(*decoded == GetParam().value);
}

TEST_P(ReportExampleTest, ValueBecomesTheBytes) {
  EXPECT_EQ(encode(GetParam().value), load_fixture(GetParam().fixture));
}

INSTANTIATE_TEST_SUITE_P(all, CommandExampleTest, ::testing::ValuesIn(command_examples()),
                         example_name<CommandExample>);
INSTANTIATE_TEST_SUITE_P(all, ReportExampleTest, ::testing::ValuesIn(report_examples()),
                         example_name<ReportExample>);

TEST(Examples, CoverEveryMessageAndEveryFixture) {
  std::set<std::size_t> commands;
  std::set<std::size_t> reports;
  std::set<std::string> fixtures;
  for (const auto& example : command_examples()) {
    commands.insert(example.value.index());
    fixtures.insert(example.fixture);
  }
  for (const auto& example : report_examples()) {
    reports.insert(example.value.index());
    fixtures.insert(example.fixture);
  }
  // All but Unknown, which is no message.
  EXPECT_EQ(commands.size(), std::variant_size_v<Command> - 1);
  EXPECT_EQ(reports.size(), std::variant_size_v<Report> - 1);
  const auto names = fixture_names();
  EXPECT_EQ(fixtures, std::set<std::string>(names.begin(), names.end()));
}

TEST(Examples, TypeIsKnownForEveryAlternative) {
  EXPECT_EQ(type_of(Command{ReverseCommand{}}), 19);
  EXPECT_EQ(type_of(Report{Unknown{57}}), 57);
}

TEST(Examples, RosDriverAsksForTheDefaults) {
  EXPECT_TRUE(ros_example() == HeadCommand{});
}

TEST(Examples, HalfDuplexIsByte146OfADstAndByte99OfOthers) {
  Bytes dst = load_fixture("bb_user_data");
  EXPECT_FALSE(std::get<BBUserData>(*decode_report(dst)).half_duplex());
  dst[99] = 1;
  EXPECT_FALSE(std::get<BBUserData>(*decode_report(dst)).half_duplex());
  dst[146] = 1;
  EXPECT_TRUE(std::get<BBUserData>(*decode_report(dst)).half_duplex());

  Bytes older(dst.begin(), dst.begin() + 174);
  older.push_back(frame_end);
  const auto blocks = std::get<BBUserData>(*decode_report(older));
  EXPECT_TRUE(blocks.half_duplex());
  EXPECT_EQ(encode(blocks).size(), 175U);
}

}  // namespace
}  // namespace sonard::micron::testing
