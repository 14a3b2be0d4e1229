// SPDX-License-Identifier: Apache-2.0
// The byte examples in both directions: bytes to values, and values to bytes.
#include "tests/unit/protocol/gemini/codec/examples.hpp"

#include <gtest/gtest.h>

#include <set>

#include "protocol/gemini/codec.hpp"
#include "tests/unit/protocol/gemini/codec/fixture.hpp"

namespace sonard::gemini::testing {
namespace {

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

TEST(Examples, CoverEveryMessageOfBothDirections) {
  std::set<std::size_t> commands;
  for (const auto& example : command_examples()) {
    commands.insert(example.value.index());
  }
  std::set<std::size_t> reports;
  for (const auto& example : report_examples()) {
    reports.insert(example.value.index());
  }
  // All but Unknown, which is no message.
  EXPECT_EQ(commands.size(), std::variant_size_v<Command> - 1);
  EXPECT_EQ(reports.size(), std::variant_size_v<Report> - 1);
}

TEST(Examples, LastAndResentLinesDifferFromTheFirstInTwoFields) {
  PingLine line = std::get<PingLine>(report_examples().at(2).value);
  line.line_id = 482;
  line.line_info = make_line_info(line.data.size(), true, 0x0204);
  Bytes start = encode(line);
  start.resize(16);
  EXPECT_EQ(start, load_fixture("ping_line_last_start"));

  line.line_id = resent_line | 10;
  line.line_info = make_line_info(line.data.size(), false, 0x0204);
  start = encode(line);
  start.resize(16);
  EXPECT_EQ(start, load_fixture("ping_line_resent_start"));
}

TEST(Examples, ProductionTestOfA32BitClientMeansTheSame) {
  const auto short_form = decode_command(load_fixture("production_test_32_bit"));
  const auto long_form = decode_command(load_fixture("production_test"));
  ASSERT_TRUE(short_form && long_form);
  EXPECT_TRUE(*short_form == *long_form);
}

TEST(Examples, HeaderIsReadableWithoutTheRest) {
  const auto header = decode_header(load_fixture("observed_ping_config_mk2"));
  ASSERT_TRUE(header);
  EXPECT_EQ(*header, (Header{.sonar_id = 1234, .version = 1, .destination = 0x1E, .source = 1}));
}

TEST(Examples, AppendingKeepsWhatIsThere) {
  Bytes out{0xAA};
  encode(PingTail{Header{.sonar_id = 601}, 5, 0}, out);
  Bytes expected{0xAA};
  const Bytes tail = load_fixture("ping_tail");
  expected.insert(expected.end(), tail.begin(), tail.end());
  EXPECT_EQ(out, expected);
}

TEST(Examples, TypeAndHeaderAreKnownForEveryAlternative) {
  EXPECT_EQ(type_of(Command{GoingOffline{}}), 0xC8);
  EXPECT_EQ(type_of(Report{PingLine{}}), 0x42);
  EXPECT_EQ(type_of(Report{Unknown{Header{}, 0x46}}), 0x46);
  EXPECT_EQ(header_of(Command{Reboot{Header{.sonar_id = 7}, 1}}).sonar_id, 7);
  EXPECT_EQ(header_of(Report{Diagnostic{Header{.sonar_id = 8}}}).sonar_id, 8);
}

}  // namespace
}  // namespace sonard::gemini::testing
