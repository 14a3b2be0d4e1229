// SPDX-License-Identifier: Apache-2.0
// The byte examples in both directions: bytes to values, and values to bytes
// (docs/protocols/ping360.md 7; tests/data/ping360/notes.md).
#include <gtest/gtest.h>

#include <set>

#include "protocol/ping360/codec.hpp"
#include "tests/unit/protocol/ping360/codec/fixture.hpp"

namespace sonard::ping360::testing {
namespace {

struct CommandExample {
  std::string fixture;
  Command value;
  std::uint8_t destination = 0;
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

std::vector<CommandExample> command_examples() {
  return {{"request_protocol_version", GeneralRequest{5}},
          {"request_device_information", GeneralRequest{4}},
          {"request_device_data", GeneralRequest{2300}},
          {"transducer", Transducer{.mode = 1,
                                    .gain_setting = 1,
                                    .angle = 200,
                                    .transmit_duration_us = 11,
                                    .sample_period = 88,
                                    .transmit_frequency_khz = 750,
                                    .number_of_samples = 1200}},
          {"transducer_brping", Transducer{.mode = 0, .angle = 100, .number_of_samples = 400}},
          {"transducer_ros_python", Transducer{.mode = 0,
                                               .gain_setting = 1,
                                               .angle = 10,
                                               .transmit_duration_us = 10,
                                               .sample_period = 88,
                                               .number_of_samples = 1200}},
          {"transducer_pnarvor", Transducer{.transmit_duration_us = 100,
                                            .sample_period = 4000,
                                            .transmit_frequency_khz = 800,
                                            .number_of_samples = 512}},
          {"auto_transmit", AutoTransmit{.transmit_duration_us = 80, .transmit_frequency_khz = 750}},
          {"motor_off", MotorOff{}},
          {"reset", Reset{}},
          {"set_device_id", Command{SetDeviceId{7}}},
          {"set_common_device_id", SetCommonDeviceId{3}, 2}};
}

const Bytes& eight_samples() {
  static const Bytes samples{0x00, 0x10, 0x20, 0x30, 0x40, 0xFF, 0x80, 0x01};
  return samples;
}
const Bytes& four_samples() {
  static const Bytes samples{9, 8, 7, 6};
  return samples;
}

std::vector<ReportExample> report_examples() {
  return {{"protocol_version", ProtocolVersion{1, 0, 0}},
          {"device_information", DeviceInformation{2, 1, 3, 3, 8}},
          {"device_data_at_boot", DeviceData{}},
          {"device_data", DeviceData{.gain_setting = 1,
                                     .angle = 200,
                                     .transmit_duration_us = 11,
                                     .sample_period = 88,
                                     .transmit_frequency_khz = 750,
                                     .number_of_samples = 8,
                                     .data = eight_samples()}},
          {"nack_sample_period", Nack{2601, "sample_period out of range"}},
          {"nack_not_recognised", Nack{100, "command not recognised"}},
          {"auto_device_data", AutoDeviceData{.angle = 399,
                                              .transmit_duration_us = 80,
                                              .transmit_frequency_khz = 750,
                                              .number_of_samples = 4,
                                              .data = four_samples()}},
          {"ack_motor_off", Ack{2903}},
          {"ascii_text", AsciiText{"hello"}}};
}

class CommandExampleTest : public ::testing::TestWithParam<CommandExample> {};
class ReportExampleTest : public ::testing::TestWithParam<ReportExample> {};

TEST_P(CommandExampleTest, BytesMeanTheValue) {
  const auto decoded = decode_command(load_fixture(GetParam().fixture));
  ASSERT_TRUE(decoded) << to_string(decoded.error());
  EXPECT_TRUE(*decoded == GetParam().value);
}

TEST_P(CommandExampleTest, ValueBecomesTheBytes) {
  EXPECT_EQ(encode(GetParam().value, client_id, GetParam().destination), load_fixture(GetParam().fixture));
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

template <class Example>
std::string example_name(const ::testing::TestParamInfo<Example>& info) {
  return info.param.fixture;
}
INSTANTIATE_TEST_SUITE_P(all, CommandExampleTest, ::testing::ValuesIn(command_examples()),
                         example_name<CommandExample>);
INSTANTIATE_TEST_SUITE_P(all, ReportExampleTest, ::testing::ValuesIn(report_examples()),
                         example_name<ReportExample>);

TEST(Ping360Examples, CoverEveryMessageAndEveryFixture) {
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
  // All but Unknown, which is no message, and a report that is also a command.
  EXPECT_EQ(commands.size(), std::variant_size_v<Command> - 1);
  EXPECT_EQ(reports.size(), std::variant_size_v<Report> - 2);
  const auto names = fixture_names();
  EXPECT_EQ(fixtures, std::set<std::string>(names.begin(), names.end()));
}

TEST(Ping360Examples, AHeadMaySayItsIdWithTheMessageThatSetsIt) {
  const Bytes bytes = load_fixture("set_device_id");
  EXPECT_TRUE(*decode_report(bytes) == Report{SetDeviceId{7}});
}

TEST(Ping360Examples, EveryFrameIsFoundBehindJunk) {
  for (const std::string& name : fixture_names()) {
    Bytes stream{0x00, 0xFF, 0x55, 0x55, 0x55};
    const Bytes frame = load_fixture(name);
    stream.insert(stream.end(), frame.begin(), frame.end());
    FrameBuffer buffer;
    buffer.append({}, stream);
    const auto found = buffer.front();
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(Bytes(found->begin(), found->end()), frame);
    EXPECT_EQ(buffer.dropped(), 5U);
    EXPECT_TRUE(buffer.take_baud_bytes());
  }
}

}  // namespace
}  // namespace sonard::ping360::testing
